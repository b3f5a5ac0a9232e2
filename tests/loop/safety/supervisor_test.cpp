// The supervisor's faults on both sides of every limit. Expected values are the limits themselves:
// a motion slightly below passes, one slightly above is a fault.
#include "loop/safety/supervisor.hpp"

#include "loop/safety/safety_chain.hpp"
#include "support/axes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace wholehand::test {
namespace {

constexpr double kT_s = 1e-3;
constexpr double kCount = 1e-5;  // encoder step of the translations

/// x, y and a finger: 1.5 m/s and 10 rad/s, ranges of 0.2 m and 3 rad, margins of 5 mm and 0.03
/// rad.
DeviceModel threeAxes() {
  DeviceModel device;
  for (int i = 0; i < 3; ++i) {
    const bool hand = i == 2;
    DeviceAxis axis;
    axis.name = i == 0 ? "x" : i == 1 ? "y" : "finger_flexion";
    axis.kind = hand ? AxisKind::kRotation : AxisKind::kTranslation;
    axis.group = hand ? AxisGroup::kHand : AxisGroup::kBase;
    axis.lower = hand ? 0.0 : -0.1;
    axis.upper = hand ? 3.0 : 0.1;
    axis.effort_limit = hand ? 0.8 : 20.0;
    axis.effort_slew_limit = 250.0 * axis.effort_limit;
    axis.speed_limit = hand ? 10.0 : 1.5;
    axis.workspace_margin = hand ? 0.03 : 0.005;
    axis.encoder_step = hand ? 1e-4 : kCount;
    device.axes.push_back(axis);
  }
  device.watch = {5, 0.02, 1.0};
  return device;
}

AxisPosition at(double x, double y = 0.0, double finger = 1.0) {
  return of<AxisPosition>(x, y, finger);
}

AxisEffort effortOnX(double effort_n) {
  return of<AxisEffort>(effort_n, 0.0, 0.0);
}

class DeviceWatch : public ::testing::Test {
 protected:
  Finding check(const AxisPosition& q, int elapsed = 1, const AxisEffort& sent = AxisEffort(3)) {
    return watchDevice(state_, q, sent, elapsed, config_);
  }
  SupervisorConfig config_ = makeSupervisor(threeAxes(), kT_s, false);
  DeviceWatchState state_;
};

TEST_F(DeviceWatch, AtRestAtAHundredHertz_NeverFindsAFault) {
  config_ = makeSupervisor(threeAxes(), 0.01, false);
  ASSERT_GT(config_.watch.late_in_a_row, 0);
  for (int k = 0; k < 1000; ++k) ASSERT_EQ(check(at(0.05)).faults, Fault::kNone) << k;
}

/// Way between two readings: as far as `speeds` times the speed limit leads in these periods, and
/// two encoder counts; a little more or less.
struct Way {
  double speeds = 0.0;
  bool more = false;
  Fault found = Fault::kNone;
  int periods = 1;
};
struct Trace {
  const char* what;
  std::vector<Way> ways;  ///< after a first reading
};
constexpr bool kLess = false, kMore = true;
const Trace kTraces[] = {
    {"rests", {{}, {}, {}}},
    {"just below the limit, and back", {{1, kLess}, {-1, kLess}}},
    {"above it once: a reading may be late", {{1, kMore}, {}}},
    {"above it twice", {{1, kMore}, {1, kMore, Fault::kSpeedLimit}}},
    {"below three times it, twice", {{3, kLess}, {3, kLess, Fault::kSpeedLimit}}},
    {"above three times it: no motion", {{3, kMore, Fault::kEncoderJump}}},
    {"skipped periods count",
     {{1, kLess, Fault::kNone, 4}, {1, kMore, Fault::kNone, 4}, {1, kMore, Fault::kSpeedLimit, 4}}},
};

TEST_F(DeviceWatch, EveryTrace_FindsItsFaultOnEveryAxisInBothDirectionsAtEveryRate) {
  const DeviceModel device = threeAxes();
  for (const double rate_hz : {200.0, 1000.0, 8000.0}) {
    config_ = makeSupervisor(device, 1.0 / rate_hz, false);
    for (int k = 0; k < 6; ++k) {
      const int axis = k / 2;
      const DeviceAxis& limits = device.axes[axis];
      for (const Trace& trace : kTraces) {
        SCOPED_TRACE(testing::Message() << trace.what << ", axis " << k << " at " << rate_hz);
        state_ = DeviceWatchState{};
        AxisPosition q = at(0.0);
        check(q);
        for (const Way& way : trace.ways) {
          const double length = std::abs(way.speeds) * way.periods * limits.speed_limit / rate_hz +
                                2.0 * limits.encoder_step + (way.more ? 1e-9 : -1e-9);
          const double sign = way.speeds * (k % 2 == 0 ? 1.0 : -1.0);
          if (sign != 0.0) q[axis] += std::copysign(length, sign);
          const Finding is = check(q, way.periods);
          ASSERT_EQ(is.faults, way.found);
          if (way.found != Fault::kNone) EXPECT_EQ(is.axis, axis);
        }
      }
    }
  }
}

TEST_F(DeviceWatch, FirstReading_HasNoSpeed) {
  EXPECT_EQ(check(at(0.09)).faults, Fault::kNone);
}

// A twentieth of the range, 0.2 m, and two counts.
TEST_F(DeviceWatch, FirstReadingSinceArming_MayBeATwentiethOfTheRangeAway) {
  const double way = 0.01 + 2.0 * kCount;
  for (const double sign : {1.0, -1.0}) {
    state_ = DeviceWatchState{};
    state_.q = at(0.02);
    EXPECT_EQ(check(at(0.02 + sign * (way - 1e-9))).faults, Fault::kNone);
    state_ = DeviceWatchState{};
    state_.q = at(0.02);
    const Finding moved = check(at(0.02 + sign * (way + 1e-9)));
    EXPECT_EQ(moved.faults, Fault::kSpeedLimit);
    EXPECT_EQ(moved.axis, 0);
    EXPECT_EQ(check(at(0.02 + sign * (way + 1e-9))).faults, Fault::kNone);  // reported once
  }
}

TEST_F(DeviceWatch, Workspace_EndsAtTheMarginBeyondTheRange) {
  EXPECT_EQ(check(at(0.105 - 1e-9)).faults, Fault::kNone);
  state_ = DeviceWatchState{};
  const Finding beyond = check(at(0.0, -0.105 - 1e-9));
  EXPECT_EQ(beyond.faults, Fault::kWorkspace);  // at once: arm() needs this
  EXPECT_EQ(beyond.axis, 1);
}

TEST_F(DeviceWatch, LateTicks_FiveInARowPassAndTheSixthStops) {
  check(at(0.0));
  for (int k = 0; k < 5; ++k) EXPECT_EQ(check(at(0.0), 2).faults, Fault::kNone) << k;
  EXPECT_EQ(check(at(0.0), 2).faults, Fault::kLateInARow);
}

TEST_F(DeviceWatch, LateTicksWithOneOnTime_CountFromZero) {
  check(at(0.0));
  for (int k = 0; k < 60; ++k) EXPECT_EQ(check(at(0.0), k % 6 == 5 ? 1 : 2).faults, Fault::kNone);
}

TEST_F(DeviceWatch, Gap_TwentyPeriodsPassAndTwentyOneStop) {
  check(at(0.0));
  EXPECT_EQ(check(at(0.0), 20).faults, Fault::kNone);
  EXPECT_EQ(check(at(0.0), 21).faults, Fault::kLongGap);
}

/// Number of the gap that is reported, counted from 1 (0: none), for `gaps` gaps of `periods`
/// periods every `every` ticks.
int reportedGap(const SupervisorConfig& config, int periods, int every, int gaps) {
  DeviceWatchState state;
  for (int k = 0; k <= gaps * every; ++k) {
    const bool gap = k > 0 && k % every == 0;
    const Finding f = watchDevice(state, at(0.0), AxisEffort(3), gap ? periods : 1, config);
    if (f.faults != Fault::kNone) return f.faults == Fault::kLateInARow ? k / every : -1;
  }
  return 0;
}

// Each gap interrupts the device's own loop: three within a second pass, the fourth stops.
TEST_F(DeviceWatch, GapsOfMoreThanFiveMilliseconds_FourWithinASecondStop) {
  EXPECT_EQ(reportedGap(config_, 6, 50, 100), 4);
  EXPECT_EQ(reportedGap(config_, 6, 100, 100), 4);
  EXPECT_EQ(reportedGap(config_, 6, 328, 100),
            4);  // 333 ms apart: the fourth 999 ms after the first
  EXPECT_EQ(reportedGap(config_, 6, 329, 100), 0);  // 334 ms apart, without end
  EXPECT_EQ(reportedGap(config_, 5, 50, 100), 0);   // five milliseconds are no gap
  EXPECT_EQ(reportedGap(makeSupervisor(threeAxes(), kT_s, true), 6, 50, 100), 0);
}

TEST_F(DeviceWatch, SimulatedDevice_IsCheckedForNeitherTimeNorEncoders) {
  config_ = makeSupervisor(threeAxes(), kT_s, true);
  check(at(0.0));
  for (int k = 0; k < 3000; ++k) {
    ASSERT_EQ(check(at(0.0), 30, effortOnX(k % 2 == 0 ? 20.0 : -20.0)).faults, Fault::kNone);
  }
}

/// Ticks until kEncoderStuck, at most `most`; `motion` gives reading and effort of tick k.
template <class Motion>
int stuckAfter(SupervisorConfig config, int most, Motion motion, int* axis = nullptr) {
  DeviceWatchState state;
  for (int k = 0; k < most; ++k) {
    const auto [q, sent] = motion(k);
    const Finding finding = watchDevice(state, q, sent, 1, config);
    if (any(finding.faults & Fault::kEncoderStuck)) {
      if (axis != nullptr) *axis = finding.axis;
      return k;
    }
  }
  return -1;
}

// A fifth of 20 N is 4 N.
TEST_F(DeviceWatch, StandingStillWhileItsEffortChanges_IsStuckAfterASecond) {
  int axis = -1;
  const auto sways = [](double amplitude) {
    return [amplitude](int k) {
      return std::pair{at(0.02), effortOnX(amplitude * std::sin(0.02 * k))};
    };
  };
  EXPECT_EQ(stuckAfter(config_, 5000, sways(2.01), &axis), 1000);
  EXPECT_EQ(axis, 0);
  EXPECT_EQ(stuckAfter(config_, 5000, sways(1.99)), -1);  // too little to be sure
}

TEST_F(DeviceWatch, EncoderThatFlickersOneCount_IsStuckAndTwoCountsAreMotion) {
  const auto flickers = [](double counts) {
    return [counts](int k) {
      return std::pair{at(0.02 + (k % 2) * counts * kCount), effortOnX(5.0 * std::sin(0.02 * k))};
    };
  };
  EXPECT_EQ(stuckAfter(config_, 5000, flickers(1.0)), 1000);
  EXPECT_EQ(stuckAfter(config_, 5000, flickers(2.0)), -1);
}

/// Rests, but for one reading that is `size` away, to which the efforts react.
struct SpikeAtRest {
  double size, period_s;
  int axis, at;
  double kick;              ///< change of the effort, as a share of its limit
  double later_kick = 0.0;  ///< again, after three seconds
};
/// The first fault of a run of five seconds.
Finding firstFault(SupervisorConfig config, const SpikeAtRest& spike) {
  DeviceWatchState state;
  const int second = static_cast<int>(std::lround(1.0 / spike.period_s));
  for (int k = 0; k < 5 * second; ++k) {
    AxisPosition q = at(0.02, 0.01, 1.5);
    AxisEffort sent(3);
    if (k == spike.at) q[spike.axis] += spike.size;
    const double limit = config.effort_limit[spike.axis];
    const double since_s = spike.period_s * (k - spike.at - 1);
    if (since_s >= 0.0) sent[spike.axis] = spike.kick * limit * std::exp(-since_s / 0.005);
    if (k > spike.at + 3 * second) sent[spike.axis] += spike.later_kick * limit;
    const Finding finding = watchDevice(state, q, sent, 1, config);
    if (any(finding.faults)) return finding;
  }
  return {};
}

// The damping answers one wrong reading with a push. The axis rests on, and its effort changed: the
// cause is the reading, not a stuck encoder.
TEST_F(DeviceWatch, SpikeOfOneReadingAtRest_IsAJumpAndNoStuckEncoder) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double period_s : {1e-3, 0.25e-3, 0.125e-3}) {
      for (const double sign : {1.0, -1.0}) {
        for (const double counts : {6.0, 30.0, 100.0}) {  // 100 counts of x are 1 mm
          config_ = makeSupervisor(threeAxes(), period_s, false);
          const double size = sign * counts * config_.encoder_step[axis];
          const Finding found = firstFault(config_, {size, period_s, axis, 700, -0.5 * sign});
          // Back and forth between one and three times the speed limit are two ticks too fast.
          const double steps = (std::abs(size) - 2.0 * config_.encoder_step[axis]) /
                               (config_.speed_limit[axis] * period_s);
          const bool too_fast = steps > 1.0 && steps <= 3.0;
          EXPECT_EQ(found.faults, too_fast ? Fault::kSpeedLimit : Fault::kEncoderJump)
              << axis << " " << period_s << " " << size;
          EXPECT_EQ(found.axis, axis);
          // A push that is no evidence of a stuck encoder ends nothing.
          if (std::abs(size) < config_.speed_limit[axis] * period_s) {
            EXPECT_EQ(firstFault(config_, {size, period_s, axis, 700, 0.1}).faults, Fault::kNone);
          }
        }
      }
    }
  }
}

TEST_F(DeviceWatch, EncoderThatSticksLongAfterASpike_IsStuck) {
  EXPECT_EQ(firstFault(config_, {1e-3, kT_s, 0, 700, 0.1, 0.5}).faults, Fault::kEncoderStuck);
  EXPECT_EQ(firstFault(config_, {3.0 * kCount, kT_s, 0, 700, 0.5}).faults, Fault::kEncoderStuck)
      << "within the counts of an axis at rest";
}

// A late reading makes one step long and the next short; that is no excess speed.
TEST_F(DeviceWatch, EverySecondReadingLate_IsNoSpeedFault) {
  for (int k = 0; k < 100; ++k) {
    const double q = 1.0e-3 * (k % 2 == 0 ? k : k + 0.8) - 0.05;
    ASSERT_EQ(check(at(q)).faults, Fault::kNone) << k;
  }
}

// Any second counts: two gaps close together are no worse than two at its ends.
TEST_F(DeviceWatch, GapsSpreadUnevenly_FourWithinAnySecondStop) {
  const auto reported = [this](std::initializer_list<int> on_time_before) {
    state_ = DeviceWatchState{};
    check(at(0.0));
    int gap = 0;
    for (const int ticks : on_time_before) {
      for (int k = 0; k < ticks; ++k) EXPECT_EQ(check(at(0.0)).faults, Fault::kNone);
      ++gap;
      if (check(at(0.0), 6).faults == Fault::kLateInARow) return gap;
    }
    return 0;
  };
  // From the first to the fourth gap 999 and 1,001 periods.
  EXPECT_EQ(reported({100, 0, 0, 981}), 4);
  EXPECT_EQ(reported({100, 0, 0, 983}), 0);
  EXPECT_EQ(reported({100, 981, 0, 0}), 4);
  EXPECT_EQ(reported({100, 983, 0, 0}), 0);
  EXPECT_EQ(reported({100, 0, 981, 0}), 4);
  EXPECT_EQ(reported({100, 0, 983, 0}), 0);
}

// y's range is 0.2 m: five times that distance.
TEST_F(DeviceWatch, BaseAxisThatStandsStillWhileTheArmTravels_IsStuck) {
  int axis = -1;
  const auto y_moves = [](int k) {
    return std::pair{at(0.02, 0.05 * std::sin(0.01 * k)), AxisEffort(3)};
  };
  EXPECT_NEAR(stuckAfter(config_, 5000, y_moves, &axis), 3143, 2);
  EXPECT_EQ(axis, 0);
}

TEST_F(DeviceWatch, AxisThatMayRest_IsNotStuck) {
  const auto arm_moves = [](int k) {
    return std::pair{at(0.05 * std::cos(0.01 * k), 0.05 * std::sin(0.01 * k)), AxisEffort(3)};
  };
  const auto fingers_move = [](int k) {
    return std::pair{at(0.02, 0.03, 1.5 + std::sin(0.005 * k)), AxisEffort(3)};
  };
  const auto pressed_at_its_stop = [](int k) {
    return std::pair{at(0.097), effortOnX(10.0 + 10.0 * std::sin(0.02 * k))};
  };
  EXPECT_EQ(stuckAfter(config_, 20000, arm_moves), -1);
  EXPECT_EQ(stuckAfter(config_, 20000, fingers_move), -1);
  EXPECT_EQ(stuckAfter(config_, 20000, pressed_at_its_stop), -1);
}

// ---- the world

TickRecord worldWith(int bodies) {
  TickRecord r;
  r.body_count = bodies;
  r.qd_s = AxisVelocity(3);
  return r;
}

class AvatarWatch : public ::testing::Test {
 protected:
  Fault check(const TickRecord& r) { return watchAvatar(state_, r, config_); }
  SupervisorConfig config_ = makeSupervisor(threeAxes(), kT_s, false);
  AvatarWatchState state_;
};

TEST_F(AvatarWatch, NonFiniteState_IsAnExplosion) {
  TickRecord r = worldWith(0);
  r.qd_s[1] = std::nan("");
  EXPECT_EQ(check(r), Fault::kBodiesExploded);
}

TEST_F(AvatarWatch, HandTenTimesTooFast_IsAnExplosion) {
  TickRecord r = worldWith(0);
  r.qd_s[0] = 14.99;
  EXPECT_EQ(check(r), Fault::kNone);
  r.qd_s[0] = -15.01;
  EXPECT_EQ(check(r), Fault::kBodiesExploded);
}

TEST_F(AvatarWatch, HandThatCatchesUpAfterAStall_IsNoExplosionIfGapsAreOnlyCounted) {
  config_ = makeSupervisor(threeAxes(), kT_s, true);
  TickRecord r = worldWith(0);
  r.elapsed_periods = 6;
  EXPECT_EQ(check(r), Fault::kNone);
  r.elapsed_periods = 1;
  r.qd_s[2] = 200.0;
  for (int k = 1; k < 200; ++k) ASSERT_EQ(check(r), Fault::kNone) << k;
  check(r);
  EXPECT_EQ(check(r), Fault::kBodiesExploded);  // 0.2 s are over
}

TEST_F(AvatarWatch, HandTooFastAfterAMonitoredGap_IsAnExplosion) {
  TickRecord r = worldWith(0);
  r.elapsed_periods = 6;
  r.qd_s[2] = 200.0;
  EXPECT_EQ(check(r), Fault::kBodiesExploded);
}

// ---- the state

TEST(SafetyState, EveryTransition_MatchesTheTable) {
  using S = SafetyState;
  const Fault none = Fault::kNone, fault = Fault::kSpeedLimit;
  EXPECT_EQ(nextSafetyState(S::kArmed, none, false, 0.5), S::kArmed);
  EXPECT_EQ(nextSafetyState(S::kArmed, none, false, 1.0), S::kRendering);
  EXPECT_EQ(nextSafetyState(S::kRendering, none, false, 1.0), S::kRendering);
  EXPECT_EQ(nextSafetyState(S::kRendering, none, false, 0.3),
            S::kRendering);  // the ramp is in progress
  EXPECT_EQ(nextSafetyState(S::kRendering, none, true, 0.0), S::kDisarmed);
  EXPECT_EQ(nextSafetyState(S::kArmed, none, true, 0.0), S::kDisarmed);
  for (const S state : {S::kArmed, S::kRendering, S::kFaulted}) {
    for (const bool at_neutral : {false, true}) {
      EXPECT_EQ(nextSafetyState(state, fault, at_neutral, 0.0), S::kFaulted);
    }
  }
}

// Every order in which a stop, an arming and a tick may occur.

TEST(StopRequests, NoRequest_ReportsNothing) {
  StopRequests stops;
  EXPECT_FALSE(stops.consumeUnseen());
  EXPECT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone);
}

TEST(StopRequests, RequestBeforeArming_IsReportedOnce) {
  StopRequests stops;
  stops.request();
  EXPECT_TRUE(stops.consumeUnseen());
  EXPECT_FALSE(stops.consumeUnseen());
  ASSERT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone) << "an old stop ended a new session";
}

TEST(StopRequests, RequestWhileArming_RefusesThatArmingOnly) {
  StopRequests stops;
  EXPECT_FALSE(stops.consumeUnseen());
  stops.requestEmergency();
  EXPECT_FALSE(stops.arm());
  EXPECT_FALSE(stops.consumeUnseen()) << "it was reported already";
  EXPECT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone);
}

TEST(StopRequests, RequestOnceArmed_IsReportedInEveryTickFromThenOn) {
  StopRequests stops;
  ASSERT_TRUE(stops.arm());
  stops.request();
  EXPECT_EQ(stops.pending(), Fault::kStopRequested);
  EXPECT_EQ(stops.pending(), Fault::kStopRequested);
  stops.requestEmergency();
  EXPECT_EQ(stops.pending(), Fault::kStopRequested | Fault::kEmergencyStop);
}

TEST(StopRequests, RequestSeenByATick_DoesNotRefuseTheNextArming) {
  StopRequests stops;
  ASSERT_TRUE(stops.arm());
  stops.requestEmergency();
  EXPECT_TRUE(any(stops.pending()));
  EXPECT_FALSE(stops.consumeUnseen());
  ASSERT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone);
}

TEST(StopRequests, RequestAfterTheLastTick_RefusesTheNextArming) {
  StopRequests stops;
  ASSERT_TRUE(stops.arm());
  EXPECT_EQ(stops.pending(), Fault::kNone);
  stops.request();
  EXPECT_TRUE(stops.consumeUnseen());
}

}  // namespace
}  // namespace wholehand::test
