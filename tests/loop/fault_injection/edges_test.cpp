// Edge cases of a run: motion between arming and the first tick, a machine that slept, a disarming
// while it renders, two faults in one tick.
#include "loop/fault_injection/fault_bench.hpp"

#include <climits>

namespace wholehand::test {
namespace {

/// Shifts the reading from the first tick on, but not yet at arming.
Sabotage movedBy(int axis, double way) {
  Sabotage out;
  out.device = {{InjectedKind::kEncoderJump, 1, INT_MAX - 1, axis, way}};
  return out;
}

// The simulated hand stands where the device was armed. The coupling would pull a device elsewhere
// back there as soon as the effort is blended in, through anything in between.
TEST(MovedSinceArming, BeyondATwentiethOfTheRange_IsAFaultAndNothingPushes) {
  const RendererConfig& config = workbench().config();
  std::mt19937_64 random = seededRandom(31);
  for (int axis = 0; axis < workbench().axes(); ++axis) {
    const DeviceAxis& of = workbench().models().device.axes[axis];
    for (const double sign : {1.0, -1.0}) {
      Bench bench(workbench(), movedBy(axis, sign * 0.06 * (of.upper - of.lower)), random, config);
      ASSERT_TRUE(bench.renderer.arm());
      for (int k = 0; k < 300; ++k) {
        const TickRecord& r = bench.tick();
        ASSERT_TRUE(same(r.sent, config.safety.neutral)) << of.name << ", tick " << k;
        ASSERT_EQ(r.safety_state, SafetyState::kFaulted);
        if (k > 0) continue;
        EXPECT_EQ(r.faults & kStoppingFaults, Fault::kSpeedLimit);
        EXPECT_EQ(r.fault_axis, axis);
      }
      bench.device.clear();
      EXPECT_TRUE(bench.renderer.arm());  // a person who holds still may try again
      EXPECT_EQ(bench.tick().safety_state, SafetyState::kArmed);
    }
  }
}

TEST(MovedSinceArming, BelowATwentiethOfTheRange_IsBlendedIn) {
  const RendererConfig& config = workbench().config();
  std::mt19937_64 random = seededRandom(32);
  for (int axis = 0; axis < workbench().axes(); ++axis) {
    const DeviceAxis& of = workbench().models().device.axes[axis];
    Bench bench(workbench(), movedBy(axis, 0.04 * (of.upper - of.lower)), random, config);
    ASSERT_TRUE(bench.renderer.arm());
    Witness witness(config);
    for (int k = 0; k < 250; ++k) {
      witness.onRecord(bench.tick());
      ASSERT_EQ(bench.record.faults & kStoppingFaults, Fault::kNone) << of.name << ", tick " << k;
    }
    EXPECT_EQ(witness.problem(), "");
    EXPECT_EQ(bench.record.safety_state, SafetyState::kRendering);
  }
}

/// Stands still, however many periods are reported as elapsed.
class StillDevice final : public RestingDevice {
 public:
  using RestingDevice::RestingDevice;
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override {
    least_periods = std::min(least_periods, elapsed_periods);
    return RestingDevice::read(reading, elapsed_periods);
  }
  int least_periods = INT_MAX;
};

// At 8 kHz 2^31 periods are three days: the process was stopped or the machine slept.
TEST(LongSleep, MorePeriodsThanAnIntHolds_AreALongGap) {
  for (const std::uint32_t periods : {3'000'000'000U, UINT32_MAX}) {
    StillDevice device(inside(workbench().models().device));
    AnalyticWorld world(workbench().models().hand,
                        Bench::stopOnFirst(workbench().models().hand.axis_count));
    HapticRenderer renderer(device, world, workbench().models().hand, SceneModel{},
                            workbench().config());
    ASSERT_TRUE(renderer.arm());
    TickRecord r;
    for (int k = 0; k < 300; ++k) renderer.tick(1, r);
    ASSERT_EQ(r.safety_state, SafetyState::kRendering);
    renderer.tick(periods, r);
    EXPECT_EQ(r.faults & Fault::kLongGap, Fault::kLongGap);
    EXPECT_EQ(r.safety_state, SafetyState::kFaulted);
    EXPECT_GE(device.least_periods, 1);
  }
}

TEST(NoPeriod, LoopThatReportsZeroPeriods_CountsAsOne) {
  std::mt19937_64 random = seededRandom(33);
  Bench bench(workbench(), {}, random, workbench().config());
  ASSERT_TRUE(bench.renderer.arm());
  for (int k = 0; k < 300; ++k) {
    bench.renderer.tick(0, bench.record);
    ASSERT_EQ(bench.record.faults & kStoppingFaults, Fault::kNone) << k;
    ASSERT_EQ(bench.record.elapsed_periods, 1U);
  }
}

// Disarming after ticks have run must let the effort down, not drop it.
TEST(Disarm, WhileItPushes_CausesNoStep) {
  const RendererConfig& config = workbench().config();
  std::mt19937_64 random = seededRandom(34);
  double largest = 0.0;
  // Runs six motions, and more if none of them pushed hard enough to show a step.
  for (int i = 0; i < 6 || (largest <= 1.0 && i < 60); ++i) {
    Bench bench(workbench(), {}, random, config);
    ASSERT_TRUE(bench.renderer.arm());
    Witness witness(config);
    for (int k = 0; k < 300 + 20 * (i % 6); ++k) witness.onRecord(bench.tick());
    for (int a = 0; a < workbench().axes(); ++a) {
      largest = std::max(largest, std::abs(bench.record.sent[a] - config.safety.neutral[a]) /
                                      config.safety.supervisor.most_change[a]);
    }
    bench.renderer.disarm();
    for (int k = 0; k < kNeutralWithin; ++k) witness.onRecord(bench.tick());
    EXPECT_EQ(witness.problem(), "");
    EXPECT_TRUE(witness.atNeutral());
    EXPECT_TRUE(bench.renderer.atNeutral());
  }
  EXPECT_GT(largest, 1.0);  // a step would have shown
}

// Runs with the smallest user limits until it stops. @return false if arming is refused.
// The record must name the cause of the stop, not an effort that was clamped in the same tick.
bool stopsAllowingTheLeast(Bench& bench) {
  std::vector<double> least;
  for (const LiveParameter& p : bench.renderer.liveParameters()) least.push_back(p.lower);
  bench.renderer.startParametersAt(least);
  if (!bench.renderer.arm()) return false;
  while (!any(bench.tick().faults & kStoppingFaults)) {
  }
  return true;
}

TEST(TwoFaults, ClampedOnOneAxisAndNanOnAnother_NameTheStoppingOne) {
  std::mt19937_64 random = seededRandom(35);
  const RendererConfig& config = workbench().config();
  int clamped = 0;
  for (int i = 0; i < 10; ++i) {
    Sabotage sabotage;
    sabotage.push = Push::kNan;
    sabotage.push_tick = 300 + 10 * i;
    sabotage.push_axis = 2;
    Bench bench(workbench(), sabotage, random, config);
    // The effort is clamped before the device's limit is reached.
    ASSERT_TRUE(stopsAllowingTheLeast(bench));
    EXPECT_EQ(bench.record.faults & kStoppingFaults, Fault::kNonFiniteEffort);
    EXPECT_EQ(bench.record.fault_axis, 2);
    clamped += any(bench.record.faults & Fault::kEffortLimit) ? 1 : 0;
  }
  EXPECT_GT(clamped, 0);
}

// A fault of the world or of a write belongs to no axis. Naming an axis that was only clamped in
// the same tick would mislead whoever repairs it.
TEST(TwoFaults, ClampedAxisBesideAFaultWithoutAxis_NameNoAxis) {
  std::mt19937_64 random = seededRandom(36);
  const RendererConfig& config = workbench().config();
  using World = InjectedWorldFault::Kind;
  int clamped = 0;
  for (const bool writing : {true, false}) {
    for (int i = 0; i < 10; ++i) {
      Sabotage sabotage;
      const int tick = 300 + 10 * i;
      if (writing) {
        sabotage.device = {{InjectedKind::kWriteFails, tick, tick, 0, 0.0}};
      } else {
        sabotage.world = {i < 8 ? World::kStepFails : World::kNonFiniteState, tick, 0};
      }
      Bench bench(workbench(), sabotage, random, config);
      // Nearly every effort is clamped then.
      ASSERT_TRUE(stopsAllowingTheLeast(bench));
      EXPECT_EQ(bench.record.fault_axis, -1) << "run " << i << (writing ? ", writing" : ", world");
      clamped += any(bench.record.faults & (Fault::kEffortLimit | Fault::kEffortSlew)) ? 1 : 0;
    }
  }
  EXPECT_GT(clamped, 0);
}

}  // namespace
}  // namespace wholehand::test
