// The assessment of own movement: its steps, its values through the whole loop, and its file.
#include "exercises/exercise_session.hpp"
#include "exercises/own_range/measuring.hpp"
#include "loop/psychometrics/comparison.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

using own_range::kFinished;
using own_range::kFirstDirection;
using own_range::kHold;
using own_range::kRelax;
using own_range::Measuring;
using own_range::MeasuringChange;
using own_range::MeasuringRules;

constexpr double kStep_s = 1e-3;

/// A finger that opens and closes, asked for both ends.
MeasuringRules fingerRules() {
  MeasuringRules out;
  out.directions = {{0, 1, rangeRulesOf(false)}, {0, -1, rangeRulesOf(false)}};
  return out;
}

struct MeasuringBench {
  MeasuringRules rules;
  Measuring measuring{rules};
  AxisPosition q = AxisPosition(1);
  std::vector<RangeTry> tries;
  int done = 0;

  explicit MeasuringBench(MeasuringRules of = fingerRules()) : rules(std::move(of)) {
    measuring.beginAt(0);
  }
  /// Moves evenly to `to` in half a second, then stays there.
  void moveTo(double to_deg, double time_s) {
    const double from = q[0], to = to_deg * kDeg;
    for (double t = 0.0; t < time_s; t += kStep_s) {
      q[0] = from + (to - from) * std::min(1.0, t / 0.5);
      const MeasuringChange news = measuring.tick(q, kStep_s);
      if (news.tried >= 0) tries.push_back(news.result);
      done += news.done ? 1 : 0;
    }
  }
  void tryTo(double to_deg) {
    moveTo(0.0, 1.6);
    moveTo(to_deg, 3.0);
  }
};

TEST(Measuring, ThreeTriesInEachDirection_GiveTheMiddleOne) {
  MeasuringBench b;
  for (const double end : {60.0, 80.0, 70.0}) b.tryTo(end);
  EXPECT_NEAR(b.measuring.measured(0).end.value, 70.0 * kDeg, 1e-9);
  EXPECT_TRUE(b.measuring.measured(0).end.steady);
  EXPECT_FALSE(b.measuring.measured(1).asked);
  for (const double end : {-20.0, -25.0, -22.0}) b.tryTo(end);
  EXPECT_NEAR(b.measuring.measured(1).end.value, -22.0 * kDeg, 1e-9);
  EXPECT_EQ(b.done, 1);
  EXPECT_TRUE(b.measuring.done());
  EXPECT_EQ(b.measuring.instruction(), kFinished);
  ASSERT_EQ(b.tries.size(), 6U);
  EXPECT_NEAR(b.tries[1].value, 80.0 * kDeg, 1e-9);
}

TEST(Measuring, Instruction_FollowsTheHand) {
  MeasuringBench b;
  EXPECT_EQ(b.measuring.instruction(), kRelax);
  b.moveTo(0.0, 1.2);
  EXPECT_EQ(b.measuring.instruction(), kFirstDirection);
  b.moveTo(50.0, 1.3);
  EXPECT_EQ(b.measuring.instruction(), kHold);
  b.moveTo(50.0, 1.0);
  EXPECT_EQ(b.measuring.instruction(), kRelax);
}

/// A hand that stays at the end is not measured there three times.
TEST(Measuring, HandThatDoesNotComeBack_HasOneTry) {
  MeasuringBench b;
  b.moveTo(0.0, 1.2);
  b.moveTo(50.0, 42.0);
  ASSERT_EQ(b.tries.size(), 3U);
  EXPECT_EQ(b.tries[0].kind, TryKind::kHeld);
  EXPECT_EQ(b.tries[1].kind, TryKind::kNoMovement);
  EXPECT_FALSE(b.measuring.measured(0).end.steady);
}

/// A person who falls asleep: every direction ends by itself, and none is known.
TEST(Measuring, NobodyMoves_AllEndsStayUnknown) {
  MeasuringBench b;
  b.moveTo(0.0, 120.0);
  EXPECT_EQ(b.done, 1);
  for (int d = 0; d < 2; ++d) EXPECT_FALSE(b.measuring.measured(d).end.steady) << d;
}

TEST(Measuring, SkippedDirection_KeepsItsTries) {
  MeasuringBench b;
  b.tryTo(60.0);
  b.tryTo(64.0);
  b.measuring.skip();
  EXPECT_NEAR(b.measuring.measured(0).end.value, 62.0 * kDeg, 1e-9);
  EXPECT_TRUE(b.measuring.measured(0).end.steady);
  EXPECT_EQ(b.measuring.direction(), 1);
  b.measuring.skip();
  EXPECT_TRUE(b.measuring.done());
  EXPECT_FALSE(b.measuring.measured(1).end.steady);
  b.measuring.skip();  // nothing is left
  EXPECT_TRUE(b.measuring.done());
}

/// A pause in the middle of a try: the hand is moved meanwhile, and the try is made again.
TEST(Measuring, DroppedTry_IsMadeAgain) {
  MeasuringBench b;
  b.moveTo(0.0, 1.2);
  b.moveTo(40.0, 0.3);
  b.measuring.dropTry();
  b.q[0] = 0.0;
  for (const double end : {60.0, 60.0, 60.0}) b.tryTo(end);
  EXPECT_EQ(b.tries.size(), 3U);
  EXPECT_NEAR(b.measuring.measured(0).end.value, 60.0 * kDeg, 1e-9);
}

TEST(Measuring, AxisThatTheDeviceLacks_IsNotAsked) {
  MeasuringRules rules = fingerRules();
  rules.directions[0].axis = -1;
  MeasuringBench b(rules);
  EXPECT_EQ(b.measuring.direction(), 1);
  rules.directions[1].axis = -1;
  EXPECT_TRUE(MeasuringBench(rules).measuring.done());
}

/// The end to which the virtual patient of this seed moves: src/exercises/own_range.
double playersEnd(const DeviceAxis& axis, double start, bool upper, std::uint64_t seed,
                  int direction) {
  const std::uint64_t drawn = splitMix64(seed + static_cast<std::uint64_t>(direction));
  const double share = 0.55 + 0.35 * static_cast<double>(drawn >> 11) * 0x1p-53;
  return start + share * ((upper ? axis.upper : axis.lower) - start);
}

/// Through the whole loop, patient and device included: every end is where the person wanted to be,
/// within what the arm's spring leaves of it; and at the held ends we add no effort.
TEST(OwnRangeExercise, PlayedByItsVirtualPatient_MeasuresItsOwnEnds) {
  for (const char* patient : {"relaxed-adult", "tremor"}) {
    SCOPED_TRACE(patient);
    ModelFiles files = exerciseFiles("own-range");
    files.patient = shippedFiles("lambda-pride", "empty", "adult-median-right", patient).patient;
    ExerciseSession session(files);
    const DeviceModel device = load(files).device;
    double most_held = 0.0;  // effort in shares of the limit
    session.on_record = [&](const TickRecord& r) {
      if (session.value("instruction") != static_cast<int>(kHold)) return;
      for (int a = 0; a < device.axisCount(); ++a) {
        most_held = std::max(most_held, std::abs(r.f_s[a]) / device.axes[a].effort_limit);
      }
    };
    session.run(1);
    const AxisPosition start = session.record->intention;
    for (int k = 0; k < 300'000 && session.value("done") != 1.0; ++k) session.run(1);
    ASSERT_EQ(session.value("done"), 1.0);
    double worst_deg = 0.0, worst_mm = 0.0;
    int directions = 0;
    for (const std::string& name : session.values) {
      if (!name.starts_with("own/")) continue;
      const bool upper = name.ends_with("_upper");
      const int axis = device.axisIndex(name.substr(4, name.size() - 10));
      const double wanted = playersEnd(device.axes[axis], start[axis], upper, 7, directions++);
      const double off = std::abs(session.value(name) - wanted);
      const bool along = device.axes[axis].kind == AxisKind::kTranslation;
      (along ? worst_mm : worst_deg) =
          std::max(along ? worst_mm : worst_deg, along ? 1e3 * off : off / kDeg);
    }
    std::printf(
        "figure: %s, own ends within %.2f degrees, %.2f mm; at most %.1f %% of the effort while "
        "held\n",
        patient, worst_deg, worst_mm, 100.0 * most_held);
    EXPECT_EQ(directions, 10);
    EXPECT_LT(worst_deg, 2.0);
    EXPECT_LT(worst_mm, 3.0);
  }
}

TEST(OwnRangeExercise, Orders_SkipPauseRestartAndResume) {
  ExerciseSession session(exerciseFiles("own-range"));
  session.run(100);
  session.tick(Act::kNext, 0.0);
  EXPECT_EQ(session.value("direction"), 1.0);
  EXPECT_TRUE(std::isnan(session.value("own/finger_flexion_lower")));
  session.tick(Act::kPause, 0.0);
  session.run(20'000);
  EXPECT_EQ(session.value("tries"), 0.0);
  session.tick(Act::kResume, 0.0);
  session.runUntil("tries", 1.0);
  const double place = session.value("place");
  session.tick(Act::kRestart, 0.0);
  EXPECT_EQ(session.told("restarted"), 1);
  EXPECT_EQ(session.value("direction"), 0.0);
  ExerciseSession after(exerciseFiles("own-range"));
  after.tick(kBeginAt, place);
  EXPECT_EQ(after.value("direction"), 1.0);
  for (const double bad : {-1.0, 11.0, std::nan("")}) {
    after.tick(kBeginAt, bad);
    EXPECT_EQ(after.value("direction"), 1.0) << bad;
  }
}

TEST(OwnRangeExercise, DeviceWithoutFingers_MeasuresTheArm) {
  ExerciseSession session(exerciseFiles("own-range", 1, "adult-median-right", "desktop-3axis"));
  session.run(10);
  EXPECT_EQ(session.value("direction"), 4.0);
}

}  // namespace
}  // namespace wholehand::test
