// Injects every stopping fault on every axis at random ticks; WHOLEHAND_FULL tries 1,000 of each.
#include "loop/core/compiler.hpp"
#include "loop/fault_injection/fault_bench.hpp"
#include "support/test_names.hpp"

namespace wholehand::test {
namespace {

using WorldKind = InjectedWorldFault::Kind;

constexpr int kLatestTick = 400;
constexpr int kReportedWithin = 2600;  // [ticks] a stuck encoder needs a second and evidence
constexpr int kGapEvery = 100;         // [ticks] between repeated gaps

struct Kind {
  const char* name;
  Fault reported;
  std::optional<InjectedKind> device;
  std::optional<WorldKind> world;
  Push push = Push::kWell;
  bool of_axis = false;
  int ramp_delay = 0;    ///< 1: a fault known only after the write starts the ramp in the next tick
  bool repeats = false;  ///< short gaps, one after another
};

Kind device(const char* name, Fault reported, InjectedKind kind, int delay = 0) {
  return {name, reported, kind, std::nullopt, Push::kWell, hasAxis(kind), delay};
}
Kind world(const char* name, Fault reported, WorldKind kind, bool of_axis = false, int delay = 0) {
  return {name, reported, std::nullopt, kind, Push::kWell, of_axis, delay};
}
Kind effort(const char* name, Push push) {
  return {name, Fault::kNonFiniteEffort, std::nullopt, std::nullopt, push, true, 0};
}
Kind repeated(const char* name, Fault reported, InjectedKind kind) {
  Kind out = device(name, reported, kind);
  out.repeats = true;
  return out;
}

std::vector<Kind> kinds() {
  return {
      device("ReadFails", Fault::kDeviceRead, InjectedKind::kReadFails),
      device("WriteFails", Fault::kDeviceWrite, InjectedKind::kWriteFails, 1),
      device("ShortReading", Fault::kDeviceRead, InjectedKind::kShortReading),
      device("NanPosition", Fault::kNonFinitePosition, InjectedKind::kNanPosition),
      device("InfinitePosition", Fault::kNonFinitePosition, InjectedKind::kInfinitePosition),
      device("NegativeInfinitePosition", Fault::kNonFinitePosition,
             InjectedKind::kNegativeInfinitePosition),
      device("EncoderJump", Fault::kEncoderJump, InjectedKind::kEncoderJump),
      device("EncoderStuck", Fault::kEncoderStuck, InjectedKind::kEncoderStuck),
      device("OverSpeed", Fault::kSpeedLimit, InjectedKind::kOverSpeed),
      device("LeavesWorkspace", Fault::kWorkspace, InjectedKind::kLeavesWorkspace),
      device("LateTicks", Fault::kLateInARow, InjectedKind::kLateTicks),
      device("LongGap", Fault::kLongGap, InjectedKind::kLongGap),
      repeated("RepeatedGaps", Fault::kLateInARow, InjectedKind::kLongGap),
      world("StepFails", Fault::kPhysicsStep, WorldKind::kStepFails, false, 1),
      world("NonFiniteState", Fault::kNonFiniteState, WorldKind::kNonFiniteState),
      world("SilentNan", Fault::kNonFiniteEffort, WorldKind::kSilentNan),
      world("SilentNanJoint", Fault::kSingularInertia, WorldKind::kSilentNanJoint),
      world("BodyExplodes", Fault::kBodiesExploded, WorldKind::kBodyExplodes),
      world("HandFliesOff", Fault::kBodiesExploded, WorldKind::kHandFliesOff, true),
      effort("NanEffort", Push::kNan),
      effort("InfiniteEffort", Push::kInfinite),
  };
}

/// Predicts the tick in which the supervisor must report, from the readings alone. Implemented
/// independently from docs/safety.md.
class Oracle {
 public:
  Oracle(const Kind& kind, const RendererConfig& config, int at, int axis)
      : kind_(kind), s_(config.safety.supervisor), at_(at), axis_(axis) {}

  /// @param sent_before effort in force when this was read
  [[nodiscard]] bool met(const TickRecord& r, const AxisEffort& sent_before) {
    const double q = r.q_m[axis_], moved = std::abs(q - q_) - 2.0 * s_.encoder_step[axis_];
    const double fastest = s_.speed_limit[axis_] * s_.period_s;
    const int tick = static_cast<int>(r.tick);
    bool met = tick == at_;
    if (kind_.reported == Fault::kEncoderJump) met = tick > 0 && moved > 3.0 * fastest;
    fast_ticks_ = tick > 0 && moved > fastest ? fast_ticks_ + 1 : 0;
    if (kind_.reported == Fault::kSpeedLimit) met = fast_ticks_ == 2;
    if (kind_.reported == Fault::kWorkspace) {
      met = q < s_.lower[axis_] - s_.margin[axis_] || q > s_.upper[axis_] + s_.margin[axis_];
    }
    if (kind_.reported ==
        Fault::kLateInARow) {  // the fourth gap within a second, or several late ticks in a row
      met = tick == at_ + (kind_.repeats ? 3 * kGapEvery : s_.watch.late_in_a_row);
    }
    if (kind_.reported == Fault::kEncoderStuck) met = stuck(r, sent_before);
    q_ = q;
    return met;
  }

  [[nodiscard]] bool atStop(double q) const {
    return q <= s_.lower[axis_] + s_.margin[axis_] || q >= s_.upper[axis_] - s_.margin[axis_];
  }

 private:
  bool stuck(const TickRecord& r, const AxisEffort& sent) {
    const double q = r.q_m[axis_];
    for (int a = 0; a < s_.axes && r.tick > 0; ++a) {
      if (s_.carries[a]) {
        travel_ += std::abs(r.q_m[a] - before_[a]) / (s_.upper[a] - s_.lower[a]);
      }
    }
    before_ = r.q_m;
    if (r.tick == 0 || atStop(q) || std::abs(q - still_at_) > 1.5 * s_.encoder_step[axis_]) {
      still_at_ = q;
      since_ = static_cast<int>(r.tick);
      least_ = most_ = sent[axis_];
      travel_ = 0.0;
    }
    least_ = std::min(least_, sent[axis_]);
    most_ = std::max(most_, sent[axis_]);
    const bool arm_moved = s_.carries[axis_] && travel_ > 5.0;
    return (static_cast<int>(r.tick) - since_) * s_.period_s >= s_.watch.stuck_encoder_s - 1e-9 &&
           (arm_moved || most_ - least_ > 0.2 * s_.effort_limit[axis_]);
  }

  const Kind& kind_;
  const SupervisorConfig& s_;
  int at_, axis_;
  double q_ = 0.0, still_at_ = 0.0, least_ = 0.0, most_ = 0.0;
  double travel_ = 0.0;  ///< of the base axes, as a share of their ranges
  AxisPosition before_;
  int since_ = 0, fast_ticks_ = 0;
};

struct Totals {
  int runs = 0, unseen = 0;
  int latest_reaction = 0;  ///< ticks from the criterion to the first smaller effort
  int latest_neutral = 0;   ///< ticks from there to exactly neutral
  double steepest = 0.0;
};

Sabotage sabotage(const Workbench& bench, const Kind& kind, int at, int axis, int refused_ticks) {
  Sabotage out;
  if (kind.device) {
    // Reads of the device are counted; arming makes the first. A write that is refused forever
    // leaves the device where it is: see WriteRefusedForEver.
    const int more =
        *kind.device == InjectedKind::kWriteFails ? refused_ticks - 1 : kReportedWithin;
    out.device = {
        faultBeyond(bench.models().device, kPeriod_s, *kind.device, axis, at + 1, at + 1 + more)};
  }
  if (kind.repeats) {  // six milliseconds each
    out.device.clear();
    for (int tick = at + 1; tick <= at + 1 + 9 * kGapEvery; tick += kGapEvery) {
      out.device.push_back({InjectedKind::kLongGap, tick, tick, 0, 5.0});
    }
  }
  if (kind.world) out.world = {*kind.world, at, axis};
  out.push = kind.push;
  out.push_tick = at;
  out.push_axis = axis;
  return out;
}

/// Checks from the tick that reported it: the ramp, exactly neutral within 100 ms, then no more
/// effort.
void expectFall(const Kind& kind, Bench& bench, Witness& witness, Totals& totals) {
  const int steps = bench.world.steps();
  const double authority = bench.record.authority;
  int neutral_after = -1;
  for (int k = 1; k <= kNeutralWithin + 20; ++k) {
    const TickRecord& r = bench.tick();
    witness.onFallingRecord(r);
    ASSERT_EQ(r.safety_state, SafetyState::kFaulted) << k;
    if (k == 1 && kind.ramp_delay == 1) {
      ASSERT_LT(r.authority, authority);
    }
    if (k == 10) {
      ASSERT_FALSE(bench.renderer.arm());  // the ramp is not finished
    }
    if (neutral_after < 0 && witness.atNeutral()) neutral_after = k;
    if (k == kNeutralWithin - 1) {
      ASSERT_TRUE(witness.atNeutral());  // the tick that reported it is the first of the 100
    }
  }
  ASSERT_TRUE(witness.atNeutral());
  ASSERT_TRUE(bench.renderer.atNeutral());
  ASSERT_EQ(bench.world.steps(), steps);
  totals.latest_neutral = std::max(totals.latest_neutral, neutral_after + 1);
}

/// Checks that after a new arming it renders again, from neutral.
void expectRearming(Bench& bench, const RendererConfig& config, int ticks) {
  bench.device.clear();
  bench.world.clear();
  bench.exercise.clear();
  const Expected<Done> armed = bench.renderer.arm();
  ASSERT_TRUE(armed) << format(armed.errors());
  Witness witness(config);
  bench.ticks = -1;
  for (int k = 0; k < ticks; ++k) witness.onRecord(bench.tick());
  EXPECT_EQ(witness.problem(), "");
  EXPECT_EQ(bench.record.faults & kStoppingFaults, Fault::kNone);
  EXPECT_GT(bench.record.authority, 0.0);
  EXPECT_EQ(bench.record.safety_state, ticks > 200 ? SafetyState::kRendering : SafetyState::kArmed);
}

void injectOne(const Workbench& workbench, const Kind& kind, int axis, std::mt19937_64& random,
               Totals& totals) {
  const int at = static_cast<int>(uniform(random, 2, kLatestTick));
  SCOPED_TRACE("tick " + std::to_string(at) + ", axis " + std::to_string(axis));
  const RendererConfig& config = workbench.config();
  const int refused_ticks = static_cast<int>(uniform(random, 1, 60));
  Bench bench(workbench, sabotage(workbench, kind, at, axis, refused_ticks), random, config);
  ASSERT_TRUE(bench.renderer.arm());
  Witness witness(config);
  Oracle oracle(kind, config, at, axis);
  AxisEffort sent = config.safety.neutral;
  double authority = 0.0;
  bool met = false;
  for (int k = 0; k <= at + kReportedWithin && !met; ++k) {
    const TickRecord& r = bench.tick();
    met = oracle.met(r, sent);
    const bool falls = met && kind.ramp_delay == 0;
    falls ? witness.onFallingRecord(r) : witness.onRecord(r);
    if (!met) {
      ASSERT_EQ(r.faults & kStoppingFaults, Fault::kNone)
          << "in tick " << k << ", too early: axis " << r.fault_axis;
      authority = r.authority;
    }
    sent = r.sent;
  }
  ++totals.runs;
  if (!met) {  // an encoder that sticks at a stop, or where a clamped effort cannot change, is not
               // detected
    ASSERT_EQ(kind.reported, Fault::kEncoderStuck);
    ASSERT_TRUE(oracle.atStop(bench.record.q_m[axis]) ||
                std::abs(bench.record.sent[axis]) >= 0.8 * config.safety.effort_limit[axis])
        << "effort " << bench.record.sent[axis];
    ++totals.unseen;
    return;
  }
  const TickRecord& reported = bench.record;
  ASSERT_EQ(reported.faults & kind.reported, kind.reported);
  ASSERT_EQ(reported.safety_state, SafetyState::kFaulted);
  if (kind.of_axis && !kind.world) {
    ASSERT_EQ(reported.fault_axis, axis);
  }
  if (kind.ramp_delay == 0) {
    ASSERT_LT(reported.authority, authority);
  }
  totals.latest_reaction = std::max(totals.latest_reaction, kind.ramp_delay);
  expectFall(kind, bench, witness, totals);
  ASSERT_EQ(witness.problem(), "");
  totals.steepest = std::max(totals.steepest, witness.steepest);
  expectRearming(bench, config, totals.runs % 10 == 0 ? 220 : 5);
}

int runsOfEach() {
  if (fullCounts()) return 1000;
  return kReducedCounts ? 2 : 6;
}

class StoppingFault : public ::testing::TestWithParam<Kind> {};

TEST_P(StoppingFault, OnEveryAxisAtRandomTicks_ReachesNeutralAndStaysUntilArmed) {
  const Kind kind = GetParam();
  static const Workbench workbench("lambda-pride");
  std::mt19937_64 random = seededRandom(11);
  Totals totals;
  for (int axis = 0; axis < (kind.of_axis ? workbench.axes() : 1); ++axis) {
    for (int i = 0; i < runsOfEach(); ++i) {
      injectOne(workbench, kind, axis, random, totals);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_LT(totals.unseen, totals.runs / 2 + 1);
  EXPECT_LE(totals.latest_reaction, 1);
  EXPECT_LE(totals.latest_neutral, kNeutralWithin);
  EXPECT_LE(totals.steepest, 1.0 + 1e-9);
  std::printf(
      "%s: %d runs, %d stuck unseen; reaction after %d tick(s), neutral after %d ms, "
      "steepest change %.3f of the slew limit\n",
      kind.name, totals.runs, totals.unseen, totals.latest_reaction, totals.latest_neutral,
      totals.steepest);
}
INSTANTIATE_TEST_SUITE_P(Kinds, StoppingFault, ::testing::ValuesIn(kinds()),
                         [](const auto& tested) { return std::string(tested.param.name); });

// Runs a few faults of every kind on the other shipped devices, which have other numbers of axes.
class OtherDevice : public ::testing::TestWithParam<std::string> {};

TEST_P(OtherDevice, EveryStoppingFaultOnARandomAxis_ReachesNeutral) {
  const Workbench workbench(GetParam());
  std::mt19937_64 random = seededRandom(12);
  Totals totals;
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    const int axis = static_cast<int>(uniform(random, 0, workbench.axes()));
    injectOne(workbench, kind, axis, random, totals);
    if (HasFatalFailure()) return;
  }
}
INSTANTIATE_TEST_SUITE_P(Devices, OtherDevice, ::testing::Values("desktop-3axis", "wrist-9axis"),
                         [](const auto& tested) { return withoutHyphens(tested.param); });

}  // namespace
}  // namespace wholehand::test
