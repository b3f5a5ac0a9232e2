// Events that do not stop rendering, that stop it without a fault, or that prevent arming.
#include "loop/fault_injection/fault_bench.hpp"

namespace wholehand::test {
namespace {

constexpr int kRuns = 6;

Sabotage pushing(Push push, int at, int axis) {
  return {.push = push, .push_tick = at, .push_axis = axis};
}

/// Runs to the end and checks that rendering continues. @return the fault bits seen from tick `at`
/// on, OR-ed
Fault expectGoesOn(Bench& bench, Witness& witness, int ticks, int at) {
  Fault seen = Fault::kNone;
  for (int k = 0; k < ticks; ++k) {
    const TickRecord& r = bench.tick();
    witness.onRecord(r);
    if (k >= at) seen |= r.faults;
    EXPECT_EQ(r.faults & kStoppingFaults, Fault::kNone) << "tick " << k << " axis " << r.fault_axis;
    if (any(r.faults & kStoppingFaults)) break;
  }
  EXPECT_EQ(witness.problem(), "");
  EXPECT_EQ(bench.record.safety_state, SafetyState::kRendering);
  EXPECT_EQ(bench.record.authority, 1.0);
  return seen;
}

struct Limit {
  const char* name;
  Push push;
  Fault reported;
};
class Limited : public ::testing::TestWithParam<Limit> {};

TEST_P(Limited, EffortOnEveryAxis_IsClampedAndReportedAndRenderingContinues) {
  const Limit limit = GetParam();
  std::mt19937_64 random = seededRandom(21);
  int runs = 0, seen_runs = 0;  // pressed hard against the stop, the sum may be at the limit anyway
  for (int axis = 0; axis < 3; ++axis) {  // a push on these does not exceed the speed limit
    for (int i = 0; i < cases(kRuns); ++i) {
      const int at = static_cast<int>(uniform(random, 210, 400));
      SCOPED_TRACE("tick " + std::to_string(at) + ", axis " + std::to_string(axis));
      const RendererConfig& config = workbench().config();
      Bench bench(workbench(), pushing(limit.push, at, axis), random, config);
      ASSERT_TRUE(bench.renderer.arm());
      Witness witness(config);
      const Fault seen = expectGoesOn(bench, witness, at + 40, at);
      ++runs;
      seen_runs += (seen & limit.reported) == limit.reported ? 1 : 0;
      EXPECT_LE(witness.steepest, 1.0 + 1e-9);
      if (HasFailure()) return;
    }
  }
  if (kStatisticsMeaningful) {
    EXPECT_GT(seen_runs, runs / 2);
  }
}
INSTANTIATE_TEST_SUITE_P(Kinds, Limited,
                         ::testing::Values(Limit{"EffortLimit", Push::kTooHard,
                                                 Fault::kEffortLimit | Fault::kEffortSlew},
                                           Limit{"SlewLimit", Push::kStep, Fault::kEffortSlew}),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(PowerLimit, ExerciseThatPushesAlongEveryMotion_StaysWithinTheLimit) {
  std::mt19937_64 random = seededRandom(22);
  int limited = 0, slewed = 0, ticks = 0;
  double largest_w = 0.0;
  for (int i = 0; i < cases(kRuns); ++i) {
    RendererConfig config = workbench().config();
    config.safety.supervisor.power_limit_w = uniform(random, 0.3, 2.0);
    Bench bench(workbench(), pushing(Push::kAlong, 210, 0), random, config);
    ASSERT_TRUE(bench.renderer.arm());
    Witness witness(config);
    for (int k = 0; k < 500; ++k) {
      const TickRecord& r = bench.tick();
      EXPECT_FALSE(any(r.faults & Fault::kWorldGivesEnergy));  // the exercise does
      if (any(r.faults & kStoppingFaults))
        break;  // pushed along its motion, a finger may exceed its speed limit
      witness.onRecord(r);
      ++ticks;
      limited += any(r.faults & Fault::kPowerLimit) ? 1 : 0;
      slewed += any(r.faults & Fault::kEffortSlew) ? 1 : 0;
      double power_w = 0.0;
      for (int a = 0; a < r.sent.size(); ++a) {
        power_w += std::max((r.sent[a] - config.safety.neutral[a]) * r.qd_mf[a], 0.0);
      }
      largest_w = std::max(largest_w, power_w / config.safety.supervisor.power_limit_w);
    }
    EXPECT_EQ(witness.problem(), "");
  }
  if (kStatisticsMeaningful) {
    EXPECT_GT(limited, ticks / 20);
  }
  std::printf("power: held in %d of %d ticks, slew limit in %d; at most %.2f of the limit\n",
              limited, ticks, slewed, largest_w);
}

TEST(EmergencyStop, AtRandomTicks_FallsToNeutralAndIsDisarmedUntilArmed) {
  std::mt19937_64 random = seededRandom(23);
  for (int i = 0; i < cases(4 * kRuns); ++i) {
    const int at = static_cast<int>(uniform(random, 2, 600));
    SCOPED_TRACE("tick " + std::to_string(at));
    const RendererConfig& config = workbench().config();
    Bench bench(workbench(), {}, random, config);
    ASSERT_TRUE(bench.renderer.arm());
    Witness witness(config);
    for (int k = 0; k < at; ++k) witness.onRecord(bench.tick());
    const double authority = bench.record.authority;
    bench.renderer.requestEmergencyStop();
    witness.onFallingRecord(bench.tick());
    EXPECT_EQ(bench.record.faults & (Fault::kEmergencyStop | Fault::kStopRequested),
              Fault::kEmergencyStop | Fault::kStopRequested);
    ASSERT_LT(bench.record.authority, authority);
    for (int k = 1; k < kNeutralWithin + 20; ++k) {
      witness.onFallingRecord(bench.tick());
      if (k == kNeutralWithin - 1) {
        ASSERT_TRUE(witness.atNeutral());
      }
    }
    EXPECT_TRUE(witness.atNeutral());
    EXPECT_EQ(witness.problem(), "");
    EXPECT_EQ(bench.record.safety_state, SafetyState::kDisarmed);
    ASSERT_TRUE(bench.renderer.arm());
    EXPECT_EQ(bench.tick().safety_state, SafetyState::kArmed);
    EXPECT_EQ(bench.record.faults & Fault::kEmergencyStop, Fault::kNone);
  }
}

// A person who presses springs forward when the device lets go; that is not a fault.
TEST(Stop, WhilePersonAndHandSpringForward_EndsDisarmedNotFaulted) {
  std::mt19937_64 random = seededRandom(29);
  const RendererConfig& config = workbench().config();
  for (int axis = 0; axis < workbench().axes(); ++axis) {
    Sabotage sabotage;
    sabotage.device = {faultBeyond(workbench().models().device, kPeriod_s, InjectedKind::kOverSpeed,
                                   axis, 306, 360)};
    sabotage.world = {InjectedWorldFault::Kind::kHandFliesOff, 310, axis};
    Bench bench(workbench(), sabotage, random, config);
    ASSERT_TRUE(bench.renderer.arm());
    Witness witness(config);
    for (int k = 0; k < 300; ++k) witness.onRecord(bench.tick());
    bench.renderer.requestStop();
    for (int k = 0; k < kNeutralWithin; ++k) {
      witness.onFallingRecord(bench.tick());
      ASSERT_EQ(bench.record.faults & kStoppingFaults, Fault::kNone) << k;
    }
    EXPECT_TRUE(witness.atNeutral());
    EXPECT_EQ(witness.problem(), "");
    EXPECT_EQ(bench.record.safety_state, SafetyState::kDisarmed);
  }
}

// Every write is refused: the record holds the effort that the device holds, not the requested one,
// and the run ends after a second so that somebody else can act.
TEST(WriteRefusedForEver, WhileRendering_IsFaultedAndFinishedAfterASecond) {
  std::mt19937_64 random = seededRandom(30);
  const RendererConfig& config = workbench().config();
  Sabotage refused;
  refused.device = {{InjectedKind::kWriteFails, 301, 5000, 0, 0.0}};
  Bench bench(workbench(), refused, random, config);
  ASSERT_TRUE(bench.renderer.arm());
  Witness witness(config);
  for (int k = 0; k < 300; ++k) witness.onRecord(bench.tick());
  const AxisEffort held = bench.record.sent;
  int ticks = 0;
  for (; ticks < 3000 && !bench.renderer.finished(); ++ticks) {
    witness.onRecord(bench.tick());
    ASSERT_EQ(std::memcmp(bench.record.sent.data(), held.data(), sizeof(double) * held.size()), 0);
    ASSERT_EQ(bench.record.safety_state, SafetyState::kFaulted);
  }
  EXPECT_FALSE(bench.renderer.atNeutral());
  EXPECT_NEAR(ticks, 1000 + 80, 5);  // the ramp, then a second of requests
  EXPECT_EQ(witness.problem(), "");
}

TEST(HolderSilent, WhileTheExercisePushes_FadesOutAndRenderingContinues) {
  std::mt19937_64 random = seededRandom(24);
  for (int i = 0; i < cases(kRuns); ++i) {
    const int at = static_cast<int>(uniform(random, 210, 500));
    const RendererConfig& config = workbench().config();
    Bench bench(workbench(), {}, random, config);
    ASSERT_TRUE(bench.renderer.arm());
    Witness witness(config);
    expectGoesOn(bench, witness, at, at);
    bench.record.command_count = 1;
    bench.record.commands[0] = {CommandType::kHolderAlive, 0, 0.0, {}};
    witness.onRecord(bench.tick());
    EXPECT_EQ(bench.record.faults & Fault::kHolderSilent, Fault::kHolderSilent);
    const Fault seen = expectGoesOn(bench, witness, 300, 0);
    EXPECT_EQ(seen & Fault::kHolderSilent, Fault::kHolderSilent);
    for (double effort : bench.record.exercise.effort) EXPECT_EQ(effort, 0.0);
  }
}

// A simulated device moves nobody, and virtual machines stall: late ticks are only counted.
TEST(Lateness, SimulatedDevice_IsOnlyCounted) {
  std::mt19937_64 random = seededRandom(25);
  RendererConfig config = workbench().config();
  config.safety.supervisor = makeSupervisor(workbench().models().device, kPeriod_s, true);
  Sabotage late;
  for (const InjectedKind kind : {InjectedKind::kLateTicks, InjectedKind::kLongGap}) {
    late.device.push_back(
        faultBeyond(workbench().models().device, kPeriod_s, kind, 0, 300, 300 + 50));
  }
  Bench bench(workbench(), late, random, config);
  ASSERT_TRUE(bench.renderer.arm());
  Witness witness(config);
  Fault seen = Fault::kNone;
  for (int k = 0; k < 700; ++k) {
    witness.onRecord(bench.tick());
    seen |= bench.record.faults;
  }
  EXPECT_EQ(witness.problem(), "");
  EXPECT_EQ(seen & (kStoppingFaults | Fault::kLateTick), Fault::kLateTick);
}

class Arming : public ::testing::TestWithParam<InjectedKind> {};

TEST_P(Arming, DeviceThatIsNotReady_IsRefusedAndNothingMoves) {
  std::mt19937_64 random = seededRandom(26);
  Sabotage not_ready;
  not_ready.device = {{GetParam(), 0, 0, 0, 0.0}};
  Bench bench(workbench(), not_ready, random, workbench().config());
  const Expected<Done> armed = bench.renderer.arm();
  ASSERT_FALSE(armed);
  EXPECT_FALSE(armed.errors().front().problem.empty());
  EXPECT_FALSE(armed.errors().front().remedy.empty());
  EXPECT_EQ(bench.renderer.safetyState(), SafetyState::kDisarmed);
  EXPECT_TRUE(same(bench.tick().sent, workbench().config().safety.neutral));
  bench.device.clear();
  EXPECT_TRUE(bench.renderer.arm());
}
INSTANTIATE_TEST_SUITE_P(Reasons, Arming,
                         ::testing::Values(InjectedKind::kNotReady, InjectedKind::kNotCalibrated,
                                           InjectedKind::kMoving));

TEST(ArmingTwice, WhileRenderingOrFalling_IsRefusedAndNothingChanges) {
  std::mt19937_64 random = seededRandom(27);
  const RendererConfig& config = workbench().config();
  Bench bench(workbench(), {}, random, config);
  ASSERT_TRUE(bench.renderer.arm());
  Witness witness(config);
  for (int k = 0; k < 300; ++k) witness.onRecord(bench.tick());
  EXPECT_FALSE(bench.renderer.arm());
  EXPECT_EQ(bench.renderer.safetyState(), SafetyState::kRendering);
  witness.onRecord(bench.tick());
  EXPECT_EQ(bench.record.authority, 1.0);
  bench.renderer.requestStop();
  for (int k = 0; k < 30; ++k) witness.onFallingRecord(bench.tick());
  EXPECT_FALSE(bench.renderer.arm());
  for (int k = 0; k < kNeutralWithin; ++k) witness.onFallingRecord(bench.tick());
  EXPECT_TRUE(witness.atNeutral());
  EXPECT_EQ(witness.problem(), "");
}

TEST(ArmingOutside, TheWorkspace_IsRefusedWithTheAxis) {
  std::mt19937_64 random = seededRandom(28);
  Sabotage outside;
  outside.device = {{InjectedKind::kEncoderJump, 0, 0, 1, 1.0}};  // 1 m away
  Bench bench(workbench(), outside, random, workbench().config());
  const Expected<Done> armed = bench.renderer.arm();
  ASSERT_FALSE(armed);
  EXPECT_EQ(armed.errors().front().key, workbench().models().device.axes[1].name);
}

}  // namespace
}  // namespace wholehand::test
