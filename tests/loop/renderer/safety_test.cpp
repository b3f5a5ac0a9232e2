// Efforts on a person's hand when something fails, through the whole tick.
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/renderer/safety_tools.hpp"
#include "support/accepting_device.hpp"
#include "support/contains.hpp"
#include "support/fault_injector.hpp"
#include "support/test_names.hpp"

namespace wholehand::test {
namespace {

struct FaultyRig {
  std::unique_ptr<SimulatedDevice> inner;
  std::unique_ptr<AcceptingDevice> accepting;  ///< wraps the device and holds what it accepted
  std::unique_ptr<Rig> rig;
  FaultInjector* device = nullptr;
};

enum class Watched { kEverything, kNoLateness };

FaultyRig faultyRig(std::vector<InjectedFault> faults, std::mt19937_64& random,
                    Watched watched = Watched::kEverything, double speed_share = 0.6,
                    double slew_per_s = 250.0) {
  FaultyRig out;
  Models m = withWeight(
      load(shippedFiles("lambda-pride", "four-shapes", "adult-median-right", "stiff-adult")));
  for (DeviceAxis& axis : m.device.axes) axis.effort_slew_limit = slew_per_s * axis.effort_limit;
  out.inner = std::make_unique<SimulatedDevice>(
      m.device, m.patient, slamming(m.device, random, clear(m.device), speed_share), kPeriod_s);
  out.accepting = std::make_unique<AcceptingDevice>(*out.inner, m.device.neutral());
  auto device = std::make_unique<FaultInjector>(*out.accepting, std::move(faults),
                                                watched == Watched::kNoLateness);
  out.device = device.get();
  out.rig = build(std::move(m), std::move(device));
  return out;
}

std::vector<TickRecord> run(FaultyRig& f, int ticks, int first_tick = 0) {
  std::vector<TickRecord> records;
  records.reserve(static_cast<std::size_t>(ticks));
  runTicks(
      *f.rig->renderer, ticks,
      [&](const TickRecord& r) {
        records.push_back(r);
        EXPECT_TRUE(same(r.sent, f.accepting->held())) << "tick " << r.tick;
      },
      first_tick);
  return records;
}

void expectWorldStands(const std::vector<TickRecord>& records, int from) {
  const TickRecord& still = records[from];
  for (std::size_t k = from + 1; k < records.size(); ++k) {
    const TickRecord& r = records[k];
    ASSERT_EQ(std::memcmp(r.q_s.data(), still.q_s.data(), sizeof(double) * r.q_s.size()), 0) << k;
    ASSERT_EQ(std::memcmp(r.bodies.data(), still.bodies.data(), sizeof(BodyState) * r.body_count),
              0)
        << k;
  }
}

struct Failure {
  const char* name;
  InjectedKind kind;
  Fault reported;
  int delay;  ///< ticks until the ramp begins: a failed write is known only after it
};

class InjectedFailure : public ::testing::TestWithParam<Failure> {};

TEST_P(InjectedFailure, AtARandomTick_RampsToNeutralAndStaysThereUntilArmed) {
  const Failure failure = GetParam();
  std::mt19937_64 random = seededRandom(1);
  int armed_again = 0;
  for (int i = 0; i < cases(3); ++i) {
    const int at =
        static_cast<int>(uniform(random, 20, 1000));  // some of them while the force engages
    // A write that is refused for long would leave the device where it is beyond any ramp, so it
    // fails only once here.
    const int lasts =
        failure.kind == InjectedKind::kWriteFails ? 0 : static_cast<int>(uniform(random, 0, 60));
    const int axis = static_cast<int>(uniform(random, 0, 6));
    // arm() is the device's first read.
    FaultyRig f = faultyRig({{failure.kind, at + 1, at + 1 + lasts, axis}}, random);
    ASSERT_TRUE(f.rig->renderer->arm());
    const std::vector<TickRecord> records = run(f, at + 300);
    ASSERT_EQ(records[at - 1].faults & kStoppingFaults, Fault::kNone);
    EXPECT_EQ(records[at].faults & kStoppingFaults, failure.reported);
    for (const TickRecord& r : records) expectWithinLimits(*f.rig->renderer, r);
    expectRamp(*f.rig->renderer, records, at + failure.delay);
    expectWorldStands(records, at);

    // After a new arming it renders again, from neutral and without a step.
    const Expected<Done> armed = f.rig->renderer->arm();
    if (!armed) continue;  // a body is where the device starts: arming is rightly refused
    ++armed_again;
    const std::vector<TickRecord> again = run(f, 15);
    EXPECT_FALSE(f.rig->renderer->atNeutral());
    EXPECT_GT(again.back().authority, 0.0);
    EXPECT_LT(again.front().authority, 1e-3);
  }
  if (kStatisticsMeaningful) {
    EXPECT_GE(armed_again, 1);  // arming must succeed at least once
  }
}
INSTANTIATE_TEST_SUITE_P(
    Kinds, InjectedFailure,
    ::testing::Values(
        Failure{"NanPosition", InjectedKind::kNanPosition, Fault::kNonFinitePosition, 0},
        Failure{"InfinitePosition", InjectedKind::kInfinitePosition, Fault::kNonFinitePosition, 0},
        Failure{"ReadFails", InjectedKind::kReadFails, Fault::kDeviceRead, 0},
        Failure{"ShortReading", InjectedKind::kShortReading, Fault::kDeviceRead, 0},
        Failure{"WriteFails", InjectedKind::kWriteFails, Fault::kDeviceWrite, 1}),
    [](const auto& tested) { return std::string(tested.param.name); });

/// Ticks until a slew-limited effort that starts now is neutral on every axis.
int ticksToNeutral(const RendererConfig& config, const AxisEffort& held) {
  double ticks = 0.0;
  for (int a = 0; a < held.size(); ++a) {
    const double span = std::abs(held[a] - config.safety.neutral[a]);
    ticks = std::max(ticks, std::ceil(span / config.safety.supervisor.most_change[a] - 1e-9));
  }
  return static_cast<int>(ticks);
}

// The lowest slew limit with which these gains are certified.
constexpr double kLowSlew_per_s = 175.0;

/// The tick after which neutral is farthest, where a refused write has its largest effect.
int tickOfTheLargestEffort(std::mt19937_64& random, int first, int last) {
  FaultyRig f = faultyRig({}, random, Watched::kEverything, 0.6, kLowSlew_per_s);
  EXPECT_TRUE(f.rig->renderer->arm());
  const std::vector<TickRecord> records = run(f, last);
  int at = first;
  for (int k = first; k < last; ++k) {
    const RendererConfig& config = f.rig->renderer->config();
    if (ticksToNeutral(config, records[k].sent) > ticksToNeutral(config, records[at - 1].sent)) {
      at = k + 1;
    }
  }
  return at;
}

// The device refuses writes for 40 ticks (in the middle of the ramp) or 150 ticks (until long after
// its end). It holds the last accepted effort, continues from there within the slew limit, and is
// reported as neutral only when it is.
TEST(RefusedWrites, ForAWhile_CauseNoStepAndNeutralIsReportedOnlyWhenAccepted) {
  std::mt19937_64 random = seededRandom(7);
  int most_ticks = 0;
  for (int i = 0; i < cases(6); ++i) {
    const std::mt19937_64 same_person = random;
    const int at = tickOfTheLargestEffort(random, 250, 1000);
    const int refused = i % 2 == 0 ? 40 : 150;
    SCOPED_TRACE("tick " + std::to_string(at) + ", refused " + std::to_string(refused));
    std::mt19937_64 again = same_person;
    FaultyRig f = faultyRig({{InjectedKind::kWriteFails, at + 1, at + refused}}, again,
                            Watched::kEverything, 0.6, kLowSlew_per_s);
    HapticRenderer& renderer = *f.rig->renderer;
    const RendererConfig& config = renderer.config();
    ASSERT_TRUE(renderer.arm());
    const AxisEffort held = run(f, at).back().sent;
    AxisEffort before = held;
    int neutral_at = -1;
    runTicks(
        renderer, 250,
        [&](const TickRecord& r) {
          const AxisEffort& now = f.accepting->held();
          const int k = static_cast<int>(r.tick) - at;
          ASSERT_TRUE(same(r.sent, now)) << k;
          ASSERT_TRUE(k >= refused || same(now, held)) << k;
          for (int a = 0; a < now.size(); ++a) {
            ASSERT_LE(std::abs(now[a] - before[a]), config.safety.supervisor.most_change[a] + 1e-12)
                << k;
            ASSERT_LE(std::abs(now[a] - config.safety.neutral[a]),
                      std::abs(before[a] - config.safety.neutral[a]) + 1e-12)
                << k;
          }
          ASSERT_EQ(renderer.atNeutral(), k >= refused && same(now, config.safety.neutral)) << k;
          ASSERT_EQ(r.safety_state, SafetyState::kFaulted) << k;
          if (neutral_at < 0 && renderer.atNeutral()) neutral_at = k;
          before = now;
        },
        at);
    const int needs = ticksToNeutral(config, held);
    most_ticks = std::max(most_ticks, needs);
    if (refused == 40) {
      EXPECT_LT(neutral_at, kNeutralWithin);  // the ramp's own time
    } else {
      EXPECT_EQ(neutral_at, refused + needs - 1);  // as fast as the slew limit allows
    }
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(most_ticks, 1);  // a step would have shown
}

TEST(StopRequest, BeforeArming_RefusesThatArmingOnce) {
  std::mt19937_64 random = seededRandom(8);
  for (const bool emergency : {false, true}) {
    FaultyRig f = faultyRig({}, random);
    HapticRenderer& renderer = *f.rig->renderer;
    emergency ? renderer.requestEmergencyStop() : renderer.requestStop();
    const Expected<Done> refused = renderer.arm();
    ASSERT_FALSE(refused);
    EXPECT_TRUE(contains(refused.errors().front().problem, "stop"));
    EXPECT_EQ(renderer.safetyState(), SafetyState::kDisarmed);
    ASSERT_TRUE(renderer.arm());
    const TickRecord last = run(f, 300).back();
    EXPECT_EQ(last.safety_state, SafetyState::kRendering);
    EXPECT_EQ(last.faults & (Fault::kStopRequested | Fault::kEmergencyStop), Fault::kNone);
  }
}

TEST(StopRequest, WhileRendering_RampsToNeutralAndStays) {
  std::mt19937_64 random = seededRandom(2);
  FaultyRig f = faultyRig({}, random);
  ASSERT_TRUE(f.rig->renderer->arm());
  std::vector<TickRecord> records = run(f, 700);
  f.rig->renderer->requestStop();
  const std::vector<TickRecord> after = run(f, 300, 700);
  records.insert(records.end(), after.begin(), after.end());
  EXPECT_EQ(records[699].faults & Fault::kStopRequested, Fault::kNone);
  EXPECT_EQ(records[700].faults & Fault::kStopRequested, Fault::kStopRequested);
  for (const TickRecord& r : records) expectWithinLimits(*f.rig->renderer, r);
  expectRamp(*f.rig->renderer, records, 700);
}

TEST(LateTicks, RandomLateTicksOnASimulatedDevice_AreReportedAndStayWithinTheLimits) {
  std::mt19937_64 random = seededRandom(3);
  FaultyRig f = faultyRig({}, random, Watched::kNoLateness);
  ASSERT_TRUE(f.rig->renderer->arm());
  TickRecord r;
  for (int k = 0; k < 1500; ++k) {
    // One tick in ten is late, by up to 30 ms.
    const auto late = random() % 10 == 0 ? static_cast<std::uint32_t>(random() % 30) : 0U;
    f.rig->renderer->tick(1 + late, r);
    ASSERT_EQ(any(r.faults & Fault::kLateTick), late > 0) << k;
    ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone) << k;
    expectWithinLimits(*f.rig->renderer, r);
    ASSERT_TRUE(allFinite(r.sent));
  }
}

TEST(ThrownDevice, FasterThanItsSpeedLimit_StopsWithinTheLimits) {
  std::mt19937_64 random = seededRandom(6);
  FaultyRig f = faultyRig({}, random, Watched::kEverything, kTooFast);
  ASSERT_TRUE(f.rig->renderer->arm());
  std::vector<TickRecord> records = run(f, 1500);
  const auto stopped = std::find_if(records.begin(), records.end(), [](const TickRecord& r) {
    return any(r.faults & kStoppingFaults);
  });
  ASSERT_NE(stopped, records.end());
  EXPECT_EQ(stopped->faults & kStoppingFaults, Fault::kSpeedLimit);
  ASSERT_GE(stopped->fault_axis, 0);
  const DeviceAxis& axis = f.rig->models.device.axes[stopped->fault_axis];
  EXPECT_GT(std::abs(stopped->q_m[stopped->fault_axis] - (stopped - 1)->q_m[stopped->fault_axis]),
            axis.speed_limit * kPeriod_s);
  EXPECT_EQ(records.back().safety_state, SafetyState::kFaulted);
  for (const TickRecord& r : records) expectWithinLimits(*f.rig->renderer, r);
  expectRamp(*f.rig->renderer, records, static_cast<int>(stopped - records.begin()));
}

class SlammingPatient : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(SlammingPatient, InAScene_StaysWithinTheDevicesEffortLimits) {
  const auto [device, scene] = GetParam();
  std::mt19937_64 random = seededRandom(4);
  for (int i = 0; i < cases(2); ++i) {
    Models m = withWeight(load(shippedFiles(device, scene, "adult-median-right", "stiff-adult")));
    // The limits are low enough to be reached, on both sides.
    for (DeviceAxis& axis : m.device.axes) {
      axis.effort_limit *= 0.25;
      axis.neutral_effort *= 0.25;
    }
    Intention intention = slamming(m.device, random, clear(m.device));
    const auto rig = orThrow(buildRig(std::move(m), std::move(intention), {}));
    const Expected<Done> armed = rig->renderer->arm();
    ASSERT_TRUE(armed) << format(armed.errors());
    int limited = 0;
    runTicks(*rig->renderer, 2000, [&](const TickRecord& r) {
      expectWithinLimits(*rig->renderer, r);
      ASSERT_TRUE(allFinite(r.sent));
      ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone) << "tick " << r.tick;
      // While the force engages, the effort rises smoothly: at most the limit's share.
      if (r.tick < 200) {
        for (int a = 0; a < r.sent.size(); ++a) {
          ASSERT_LE(std::abs(r.sent[a] - rig->renderer->config().safety.neutral[a]),
                    2.0 * r.authority * rig->models.device.axes[a].effort_limit + 1e-12);
        }
      }
      limited += any(r.faults & Fault::kEffortLimit) ? 1 : 0;
    });
    EXPECT_GT(limited, 0);  // the limit was needed
  }
}
INSTANTIATE_TEST_SUITE_P(
    DevicesAndScenes, SlammingPatient,
    ::testing::Values(std::pair<std::string, std::string>{"lambda-pride", "four-shapes"},
                      std::pair<std::string, std::string>{"lambda-pride", "table"},
                      std::pair<std::string, std::string>{"desktop-3axis", "four-shapes"},
                      std::pair<std::string, std::string>{"wrist-9axis", "four-shapes"}),
    [](const auto& tested) { return withoutHyphens(tested.param.first + tested.param.second); });

}  // namespace
}  // namespace wholehand::test
