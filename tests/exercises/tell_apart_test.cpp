#include "exercises/tell_apart/comparing.hpp"
#include "loop/psychometrics/answer_log.hpp"
#include "loop/psychometrics/threshold.hpp"
#include "rig/run/run.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <cmath>
#include <cstdio>

namespace wholehand::test {
namespace {

using tell_apart::Comparing;
using tell_apart::ComparingChange;
using tell_apart::ComparingRules;
using tell_apart::HandNow;
using Asks = tell_apart::Instruction;
using tell_apart::kBottles;
using tell_apart::Said;

constexpr double kStep_s = 0.01;

ComparingRules comparingRules() {
  ComparingRules out;
  out.most_level = out.scale.count - 1;
  out.rest_s = 0.0;
  return out;
}

/// Ticks through a block, as a person's hand would.
struct ComparingBench {
  ComparingRules rules;
  Comparing comparing{rules};
  int answered = 0, again = 0, too_early = 0;

  explicit ComparingBench(ComparingRules of = comparingRules()) : rules(of) { comparing.begin(0); }

  void run(const HandNow& hand, double time_s, const Said& said = {}) {
    for (double t = 0.0; t < time_s; t += kStep_s) {
      const ComparingChange news = comparing.tick(hand, said, kStep_s);
      answered += news.answered;
      again += news.again >= 0;
      too_early += news.too_early;
      if (said.bottle >= 0) return run(hand, time_s - t - kStep_s);
    }
  }
  void letGo() { run({}, 0.1); }
  void squeeze(int bottle) {
    run({bottle, 1.1, false, false}, 1.0);
    letGo();
  }
  void squeezeBoth() {
    squeeze(0);
    squeeze(1);
  }
  void say(int bottle, SaidBy by = SaidBy::kPlayer) { run({}, 0.05, {bottle, by}); }
};

TEST(Comparing, SqueezedAndAnsweredBySqueezing_CountsTheAnswerOfThatBottle) {
  ComparingBench b;
  EXPECT_EQ(b.comparing.instruction(), Asks::kFirst);
  b.squeeze(0);
  EXPECT_EQ(b.comparing.instruction(), Asks::kSecond);
  b.squeeze(1);
  EXPECT_EQ(b.comparing.instruction(), Asks::kAnswer);
  b.squeeze(1);
  ASSERT_EQ(b.answered, 1);
  EXPECT_TRUE(b.comparing.block().answers()[0].said_second);
  EXPECT_EQ(b.comparing.saidBy(), SaidBy::kSqueeze);
}

/// The first comparison is at the level nearest to x = 0.5, is kept, and its own step is taken:
/// pitfalls of other implementations.
TEST(Comparing, FirstAnswer_IsKeptWithItsLevelAndMovesByItsOwnStep) {
  ComparingBench b;
  const int first = b.comparing.block().level();
  EXPECT_EQ(first, b.rules.scale.nearest(0.5));
  const bool second = b.comparing.now().x > 0.0;
  b.squeezeBoth();
  b.say(second ? 0 : 1);  // wrong
  ASSERT_EQ(b.comparing.block().answers().size(), 1U);
  EXPECT_DOUBLE_EQ(std::abs(b.comparing.block().answers()[0].x), b.rules.scale.at(first));
  const auto next = b.comparing.now();
  if (!next.is_catch) EXPECT_EQ(b.comparing.block().level(), first + 3);
}

TEST(Comparing, AnswerBeforeTheSecondSqueeze_IsIgnored) {
  ComparingBench b;
  b.say(1);
  b.squeeze(0);
  b.say(1);
  EXPECT_EQ(b.answered, 0);
  EXPECT_EQ(b.too_early, 2);
  EXPECT_EQ(b.comparing.instruction(), Asks::kSecond);
}

TEST(Comparing, SqueezeLetGoBeforeTheMark_IsRepeatedAndNotCounted) {
  ComparingBench b;
  b.run({0, 0.6, false, false}, 2.0);
  b.letGo();
  EXPECT_EQ(b.again, 1);
  EXPECT_EQ(b.comparing.instruction(), Asks::kFirst);
  b.squeezeBoth();
  EXPECT_EQ(b.comparing.instruction(), Asks::kAnswer);
  EXPECT_EQ(b.answered, 0);
}

TEST(Comparing, WrongBottle_IsNoSqueeze) {
  ComparingBench b;
  b.squeeze(1);
  EXPECT_EQ(b.comparing.instruction(), Asks::kFirst);
}

TEST(Comparing, BothAtOnce_AsksToLetGoAndRepeats) {
  ComparingBench b;
  b.run({0, 1.1, false, true}, 2.0);
  EXPECT_EQ(b.comparing.instruction(), Asks::kOneAtATime);
  EXPECT_GT(b.again, 0);
  b.letGo();
  EXPECT_EQ(b.comparing.instruction(), Asks::kFirst);
  b.squeezeBoth();
  b.run({1, 1.1, false, true}, 2.0);
  EXPECT_EQ(b.answered, 0) << "an answer with both is none";
  b.letGo();
  b.squeeze(1);
  EXPECT_EQ(b.answered, 1);
}

TEST(Comparing, NoAnswerForAMinute_RepeatsTheComparison) {
  ComparingBench b;
  b.squeezeBoth();
  const double x = b.comparing.now().x;
  b.run({}, Comparing::kAnswer_s + 1.0);
  EXPECT_EQ(b.again, 1);
  EXPECT_EQ(b.answered, 0);
  EXPECT_EQ(b.comparing.instruction(), Asks::kFirst);
  EXPECT_EQ(b.comparing.now().x, x);
}

TEST(Comparing, PersonWhoSleeps_EndsTheBlockAfterItsTime) {
  ComparingBench b;
  b.squeezeBoth();
  b.say(1);
  b.run({}, b.rules.most_s);
  EXPECT_TRUE(b.comparing.done());
  EXPECT_EQ(b.comparing.answers(), 1);
}

TEST(Comparing, TherapistWhoAnswers_IsNamed) {
  ComparingBench b;
  b.squeezeBoth();
  b.say(0, SaidBy::kTherapist);
  EXPECT_EQ(b.answered, 1);
  EXPECT_EQ(b.comparing.saidBy(), SaidBy::kTherapist);
}

TEST(Comparing, HandThatNeverLetsGo_GoesNoFurther) {
  ComparingBench b;
  b.run({0, 1.1, false, false}, 20.0);
  EXPECT_EQ(b.comparing.instruction(), Asks::kLetGo);
}

/// The block ends with its answers, at whatever level, and only then.
TEST(Comparing, Block_EndsWithItsLastAnswerAndNeverWaits) {
  for (const int wrong_every : {1, 2, 3, 1000}) {
    ComparingBench b;
    for (int i = 0; i < b.rules.answers; ++i) {
      ASSERT_FALSE(b.comparing.done()) << i;
      const int more = b.comparing.now().x > 0.0 ? 1 : 0;
      b.squeezeBoth();
      b.say(i % wrong_every == 0 ? 1 - more : more);
      ASSERT_EQ(b.comparing.answers(), i + 1);
    }
    b.letGo();
    EXPECT_TRUE(b.comparing.done());
  }
}

TEST(Comparing, Rest_FollowsTheNumberOfAnswers) {
  ComparingRules with = comparingRules();
  with.rest_every = 2;
  with.rest_s = 3.0;
  ComparingBench b(with);
  for (int i = 0; i < 2; ++i) {
    b.squeezeBoth();
    b.say(1);
  }
  b.letGo();
  EXPECT_EQ(b.comparing.instruction(), Asks::kRest);
  b.run({}, 3.1);
  EXPECT_EQ(b.comparing.instruction(), Asks::kFirst);
}

/// A stop in the middle: from the place the block goes on as if nothing had been.
TEST(Comparing, BeganAtThePlaceOfEveryAnswer_GoesOnAlike) {
  ComparingBench b;
  b.comparing.begin(3);
  for (int i = 0; i < b.rules.answers; ++i) {
    Comparing again(b.rules);
    again.beginAt(b.comparing.place());
    ASSERT_EQ(again.answers(), i);
    ASSERT_EQ(again.now().x, b.comparing.now().x);
    ASSERT_EQ(again.now().other, b.comparing.now().other);
    ASSERT_EQ(again.now().is_catch, b.comparing.now().is_catch);
    ASSERT_EQ(again.varied(1), b.comparing.varied(1));
    ASSERT_EQ(again.place(), b.comparing.place());
    b.squeezeBoth();
    b.say(static_cast<int>(b.comparing.now().other > 0.0));
  }
}

TEST(Comparing, PlaceThatIsNone_BeginsANewBlock) {
  ComparingBench b;
  for (const double place : {0.0, -1.0, 0.5, 1e300, std::nan(""), HUGE_VAL}) {
    b.comparing.beginAt(place);
    EXPECT_EQ(b.comparing.answers(), 0) << place;
  }
}

/// One of both has the least; the other e^|x| times as much.
TEST(Comparing, Amounts_DifferByX) {
  ComparingBench b;
  EXPECT_DOUBLE_EQ(b.comparing.amount(1) - b.comparing.amount(0), b.comparing.now().x);
  EXPECT_EQ(std::min(b.comparing.amount(0), b.comparing.amount(1)), 0.0);
}

const std::vector<std::string> kQuantities = {"firmer", "thicker", "farther", "heavier", "later"};

/// What the virtual patient's block was like.
struct Played {
  bool done = false;
  double time_s = 0.0;
  std::vector<Comparison> answers;
};

Played play(const std::string& quantity, const std::string& hand, int seconds) {
  Models models = load(exerciseFiles("tell-apart-" + quantity, 1, hand));
  const ExerciseDescription& d = models.exercise->description();
  AnswerLog log(d.value_names, d.event_names);
  const auto done = std::find(d.value_names.begin(), d.value_names.end(), "done");
  const auto at = done - d.value_names.begin();
  std::unique_ptr<Player> player = models.exercise->makePlayer({7});
  const auto rig = orThrow(buildRig(std::move(models), std::move(player), RigOptions{}));
  orThrow(rig->renderer->arm());
  Played out;
  runTicks(*rig->renderer, seconds * 1000, [&](const TickRecord& r) {
    EXPECT_EQ(r.faults & kStoppingFaults, Fault::kNone);
    rig->listener->afterTick(r);
    log.add(r);
    if (!out.done && r.exercise.values[at] > 0.5) {
      out.done = true;
      out.time_s = r.time_s;
    }
  });
  out.answers = log.comparisons();
  return out;
}

/// The first comparisons of every quantity; a whole block is in the _slow test.
TEST(TellApart, PlayedByItsVirtualPatient_ComparesInEveryQuantity) {
  for (const std::string& quantity : sampleTenth<std::string>(kQuantities)) {
    SCOPED_TRACE(quantity);
    const Played played = play(quantity, "adult-median-right", 30);
    EXPECT_GE(played.answers.size(), 3U);
    std::printf("figure: %s, %zu answers in 30 s\n", quantity.c_str(), played.answers.size());
  }
}

/// A whole block of every quantity: at most 8 minutes of program time, no stop.
TEST(TellApart, WholeBlockOfEveryQuantity_EndsWithin8Minutes_slow) {
  for (const std::string& quantity : kQuantities) {
    SCOPED_TRACE(quantity);
    const Played played = play(quantity, "adult-median-right", 481);
    EXPECT_TRUE(played.done);
    EXPECT_EQ(played.answers.size(), 50U);
    EXPECT_LE(played.time_s, 480.0);
    const ThresholdFinding finding = findThreshold(played.answers, {0.02, std::log(3.0)});
    const Threshold& t = finding.threshold;
    std::printf("figure: %s, %.0f s, sigma %.3f (%.3f to %.3f), doubts %d, other %.2f\n",
                quantity.c_str(), played.time_s, t.observer.sigma, t.low, t.high,
                finding.doubts.any(), finding.doubts.other_right);
  }
}

}  // namespace
}  // namespace wholehand::test
