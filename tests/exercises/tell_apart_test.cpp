#include "certify/certificate.hpp"
#include "exercises/exercise_session.hpp"
#include "exercises/tell_apart/comparing.hpp"
#include "loop/psychometrics/answer_log.hpp"
#include "loop/psychometrics/threshold.hpp"
#include "rig/run/run.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>

namespace wholehand::test {
namespace {

using tell_apart::Comparing;
using tell_apart::ComparingChange;
using tell_apart::ComparingRules;
using tell_apart::HandNow;
using Asks = tell_apart::Instruction;
using tell_apart::GivenAnswer;
using tell_apart::kBottles;

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

  void run(const HandNow& hand, double time_s, const GivenAnswer& said = {}) {
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

/// A session of the virtual patient, and its answers.
struct TellApartSession : ExerciseSession {
  std::unique_ptr<AnswerLog> log;

  explicit TellApartSession(const std::string& quantity = "firmer")
      : TellApartSession(exerciseFiles("tell-apart-" + quantity)) {}
  explicit TellApartSession(const ModelFiles& files) : ExerciseSession(files) {
    log = std::make_unique<AnswerLog>(values, events);
    on_record = [this](const TickRecord& r) { log->add(r); };
  }
};

TEST(TellApart, AnswerByOrder_CountsOnlyAfterBothSqueezesAndSaysByWhom) {
  TellApartSession session;
  session.run(100);
  session.tick(Act::kNext, choiceValue(Choice::kFirst, false));
  EXPECT_TRUE(session.told("too_early"));
  EXPECT_TRUE(session.log->answers().empty());
  session.runUntil("answering", 1.0);
  session.tick(Act::kNext, choiceValue(Choice::kSecond, true));
  ASSERT_EQ(session.log->answers().size(), 1U);
  EXPECT_EQ(session.log->answers()[0].by, SaidBy::kTherapist);
  EXPECT_TRUE(session.log->answers()[0].comparison.said_second);
  session.runUntil("answering", 0.0);
  session.runUntil("answering", 1.0);
  session.tick(Act::kNext, choiceValue(Choice::kFirst, false));
  ASSERT_EQ(session.log->answers().size(), 2U);
  EXPECT_EQ(session.log->answers()[1].by, SaidBy::kPlayer);
  EXPECT_FALSE(session.log->answers()[1].comparison.said_second);
}

/// The session after a rest goes on at the trial, and its record holds the answers before it.
TEST(TellApart, SessionAfterARest_GoesOnAtTheTrial) {
  TellApartSession before;
  before.runUntil("answers", 3.0);
  const double place = before.value("place");
  TellApartSession after;
  after.tick(kBeginAt, place);
  after.run(10);
  EXPECT_EQ(after.value("answers"), 3.0);
  ASSERT_EQ(after.log->answers().size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(after.log->answers()[i].by, SaidBy::kEarlier);
    EXPECT_EQ(after.log->comparisons()[i].x, before.log->comparisons()[i].x);
    EXPECT_EQ(after.log->comparisons()[i].said_second, before.log->comparisons()[i].said_second);
  }
  after.runUntil("answers", 4.0);
  EXPECT_EQ(after.log->answers().size(), 4U);
  EXPECT_EQ(after.log->answers()[3].by, SaidBy::kSqueeze);
}

/// No stimulus begins or ends with a jump of the effort: at most 0.05 N a tick at the tip, as every
/// exercise (docs/exercises.md), while the effort falls.
TEST(TellApart, FallOfTheEffort_IsGentle) {
  for (const char* quantity : {"firmer", "later"}) {
    TellApartSession session(quantity);
    double before_n = 0.0, most_n = 0.0;
    for (int k = 0; k < 20'000; ++k) {
      session.run(1);
      const double now_n = -session.record->exercise.effort[3] / 0.08;
      most_n = std::max(most_n, before_n - now_n);
      before_n = now_n;
    }
    std::printf("figure: %s, fastest fall %.4f N a tick\n", quantity, most_n);
    EXPECT_LT(most_n, 0.05);
  }
}

/// The shipped file and its scene, with one change.
ModelFiles changedFiles(const Folder& folder, const std::string& quantity, const std::string& find,
                        const std::string& with) {
  std::string text = bytesOfFile(exerciseFiles("tell-apart-" + quantity).exercise);
  const std::size_t at = text.find(find);
  EXPECT_NE(at, std::string::npos) << find;
  text.replace(at, find.size(), with);
  folder.write("scenes/tell-apart.toml",
               bytesOfFile(std::string(WHOLEHAND_SOURCE_DIR) + "/config/scenes/tell-apart.toml"));
  ModelFiles files = exerciseFiles("tell-apart-" + quantity);
  files.exercise = folder.write("exercises/changed.toml", text);
  return files;
}

std::string refusalOf(const std::string& quantity, const std::string& find,
                      const std::string& with) {
  const Folder folder;
  auto models = loadModels(changedFiles(folder, quantity, find, with));
  if (!models) return format(models.errors());
  std::unique_ptr<Player> player = models->exercise->makePlayer({7});
  const auto rig = buildRig(std::move(*models), std::move(player), RigOptions{});
  return rig ? "" : format(rig.errors());
}

TEST(TellApart, Answer_IsCalledRightOrWrongOnlyWhereTheFileSaysSo) {
  const Folder folder;
  for (const bool says : {false, true}) {
    TellApartSession session(changedFiles(folder, "firmer", "says_right = false",
                                          says ? "says_right = true" : "says_right = false"));
    for (int answer = 0; answer < 2; ++answer) {
      session.runUntil("answering", 1.0);
      const bool second_is_more = session.value("x") > 0.0;
      const bool right = answer == 0;  // the first answer is right, the next one is wrong
      session.tick(Act::kNext,
                   choiceValue(second_is_more == right ? Choice::kSecond : Choice::kFirst, false));
      EXPECT_TRUE(session.told("answered"));
      EXPECT_EQ(session.told("right"), says && right ? 1 : 0);
      EXPECT_EQ(session.told("wrong"), says && !right ? 1 : 0);
      session.runUntil("answering", 0.0);
    }
  }
}

/// The file asks for walls of up to 900 N/m at the tip. The largest level is the one whose walls
/// pass the certificate, while those of the next one do not.
TEST(TellApart, RangeBeyondTheCertificate_IsLoweredToIt) {
  const Folder folder;
  const ModelFiles files =
      changedFiles(folder, "firmer", "stiffness_tip_n_m = 120.0", "stiffness_tip_n_m = 300.0");
  const Models models = orThrow(loadModels(files));
  const double most_x =
      nlohmann::json::parse(models.exercise->description().json).at("most_x").get<double>();
  EXPECT_LT(most_x, std::log(2.9));
  EXPECT_GT(most_x, 0.02);
  EXPECT_TRUE(certify(certificateInput(models, 1e-3)).certified);
  const LevelScale scale;
  const double step = scale.at(scale.nearest(most_x) + 1) - most_x;
  Models stiffer = models;
  for (ExerciseWall& wall : stiffer.exercise_walls) wall.stiffness *= std::exp(step);
  EXPECT_FALSE(certify(certificateInput(stiffer, 1e-3)).certified);
  // The shipped file is borne whole.
  const Models shipped = orThrow(loadModels(exerciseFiles("tell-apart-firmer")));
  EXPECT_NEAR(
      nlohmann::json::parse(shipped.exercise->description().json).at("most_x").get<double>(),
      std::log(3.0), 1e-5);
}

TEST(TellApart, FaultyFiles_AreRefusedWithTheRemedy) {
  EXPECT_EQ(refusalOf("firmer", "seed = 1", "seed = 2"), "");
  struct Case {
    const char *quantity, *find, *with, *expected;
  };
  for (const Case& c : std::initializer_list<Case>{
           // Not even the least level is within the certificate.
           {"firmer", "stiffness_tip_n_m = 120.0", "stiffness_tip_n_m = 1000.0", "finger_flexion"},
           {"firmer", "quantity = \"firmer\"", "quantity = \"softer\"", "heavier"},
           {"firmer", "quantity = \"firmer\"", "quantity = \"heavier\"", "heavier most_n"},
           {"firmer", "quantity = \"firmer\"", "quantity = \"thicker\"", "opens_s"},
           {"farther", "depth_m = 0.004", "depth_m = 0.012", "of soft shell"},
           {"firmer", "most_ratio = 3.0", "most_ratio = 4.0", "3]"},
           {"firmer", "answers = 50", "answers = 80", "50"},
           {"firmer", "first = \"lower_bottle\"", "first = \"nothing\"", "has no such body"},
           {"firmer", "first = \"lower_bottle\"", "first = \"counter\"", "cylinder"},
       }) {
    const std::string said = refusalOf(c.quantity, c.find, c.with);
    EXPECT_TRUE(contains(said, c.expected)) << c.with << "\n" << said;
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
