// ConsoleOperator without a network: the orders that reach the commissioning, and the facts that
// pages get.
#include "devices/commissioning/console/console_operator.hpp"

#include "devices/commissioning/commissioning.hpp"
#include "station/server/access.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::test {
namespace {

using Facts = CommissioningFacts;

const Question kNumber{QuestionKind::kTravel, "How far?", "x", "m", 0.0, 0.0};

/// One therapist's page, with a clock that the test sets.
struct Page {
  OrderReply order(Order asked) {
    asked.claim = 1;
    OrderReply reply;
    console.order(asked, [&](OrderReply r) { reply = std::move(r); });
    return reply;
  }
  OrderReply answer(std::uint32_t question, const std::string& text) {
    return order({orders::Answer{question, text}});
  }
  OrderReply hold(std::uint32_t press, bool held = true) {
    return order({orders::HoldToMove{press, held}});
  }
  OrderReply give(const orders::Any& what) { return order({what}); }
  /// Presses the button for longer than a click.
  void press(std::uint32_t number) {
    for (int i = 0; i < 6; ++i, now_ns += 50'000'000) (void)hold(number);
    now_ns -= 50'000'000;
  }

  std::int64_t now_ns = 1'000'000'000;
  std::atomic<bool> ended{false};
  ConsoleOperator console{
      {}, {0, 1, 2}, [this] { return now_ns; }, [this] { return ended.load(); }};
};

TEST(ConsoleOperator, AnswerToTheOpenQuestion_IsTakenOnce) {
  Page page;
  EXPECT_EQ(page.answer(0, "yes").refusal, Refusal::kNotAsked) << "nothing is asked";
  int looks = 0;
  const auto got = page.console.ask(kNumber, [&] {
    if (++looks > 1) return;
    EXPECT_EQ(page.console.facts()->asked, QuestionKind::kTravel);
    EXPECT_EQ(page.console.facts()->unit, "m");
    EXPECT_EQ(page.answer(2, "0.1").refusal, Refusal::kNotAsked) << "another question";
    EXPECT_EQ(page.answer(1, std::string(65, '1')).refusal, Refusal::kOutOfRange);
    EXPECT_TRUE(page.answer(1, "0.122").accepted);
    EXPECT_EQ(page.answer(1, "0.2").refusal, Refusal::kNotAsked) << "a second press";
  });
  EXPECT_EQ(got, std::optional<std::string>("0.122"));
  EXPECT_EQ(page.console.facts()->asked, QuestionKind::kNothing);
}

TEST(ConsoleOperator, DeviceThatDoesNotAnswer_IsTheAlarmOfARobot) {
  Page page;
  EXPECT_EQ(alarmOf(page.console.status()), nullptr);
  page.console.setSilent(true);
  EXPECT_STREQ(alarmOf(page.console.status()), kNoAnswer) << "the terminal says the same words";
  page.console.setSilent(false);
  EXPECT_EQ(alarmOf(page.console.status()), nullptr);
}

TEST(ConsoleOperator, EveryLossOfTheButton_EndsThePress) {
  const std::vector<std::pair<const char*, std::function<void(Page&)>>> ways = {
      {"let go", [](Page& p) { (void)p.hold(1, false); }},
      {"beats that stop", [](Page& p) { p.now_ns += HoldSwitch::kSilent_ns + 1; }},
      {"a stop", [](Page& p) { EXPECT_TRUE(p.give(orders::Stop{}).accepted); }},
      {"an emergency stop", [](Page& p) { EXPECT_TRUE(p.give(orders::EmergencyStop{}).accepted); }},
      {"a leader that vanished or is silent",
       [](Page& p) { (void)p.give(orders::HolderAlive{false}); }},
      {"another leader", [](Page& p) { (void)p.give(orders::Steer{}); }},
      {"the end of the program", [](Page& p) { p.ended = true; }}};
  for (const auto& [name, lose] : ways) {
    Page page;
    page.press(1);
    ASSERT_TRUE(page.console.holdsKey()) << name;
    lose(page);
    EXPECT_FALSE(page.console.holdsKey()) << name;
    page.press(1);
    EXPECT_FALSE(page.console.holdsKey()) << name << ": late beats of the same press";
  }
}

// Only the newest press holds. Its release ends it, and so does the release of an earlier press.
TEST(ConsoleOperator, KeyHeldByTwoPages_EndsWhenEitherReleases) {
  const auto beat = [](Page& p, std::uint32_t claim, bool held) {
    Order asked{orders::HoldToMove{1, held}};
    asked.claim = claim;
    p.console.order(asked, [](const OrderReply&) {});
  };
  const auto both = [&](Page& p, int times) {
    for (int i = 0; i < times; ++i, p.now_ns += 40'000'000) {
      beat(p, 1, true);
      beat(p, 2, true);
    }
  };
  for (const std::uint32_t lets_go : {1U, 2U}) {
    Page page;
    both(page, 8);
    ASSERT_TRUE(page.console.holdsKey());
    beat(page, lets_go, false);
    EXPECT_FALSE(page.console.holdsKey()) << "let go by page " << lets_go;
    both(page, 8);
    EXPECT_FALSE(page.console.holdsKey()) << "the other one must be pressed anew";
  }
  Page page;
  both(page, 8);
  for (int i = 0; i < 4; ++i, page.now_ns += 40'000'000) beat(page, 1, true);
  EXPECT_FALSE(page.console.holdsKey()) << "the newer page is silent, the older one beats on";
}

TEST(ConsoleOperator, ButtonHeldThroughAQuestion_MovesNothingAfterIt) {
  Page page;
  page.press(1);
  ASSERT_TRUE(page.console.holdsKey());
  const auto got = page.console.ask(kNumber, [&] {
    page.press(2);
    EXPECT_FALSE(page.console.holdsKey());
    (void)page.answer(1, "1");
  });
  ASSERT_TRUE(got.has_value());
  page.press(2);
  EXPECT_FALSE(page.console.holdsKey());
  page.press(3);
  EXPECT_TRUE(page.console.holdsKey());
}

TEST(ConsoleOperator, StepsAndFigures_AreReportedWithTheFailure) {
  Page page;
  page.console.reportStep({0, StepState::kUnderWay, {}});
  page.console.reportStep({0, StepState::kDone, {}});
  page.console.reportStep({1, StepState::kUnderWay, {}});
  page.console.reportLine("  x: ...", {{"x", "mass", "kg", 0.98, 1.02}});
  page.console.reportStep(
      {1, StepState::kFailed, {{"mine.toml", 0, "axes", "x", "is too heavy", "balance it"}}});
  const auto facts = page.console.facts();
  EXPECT_EQ(facts->steps[0].state, StepState::kDone);
  EXPECT_EQ(facts->steps[1].name, stepName(CommissioningStep::kHome));
  EXPECT_EQ(facts->steps[1].state, StepState::kFailed);
  EXPECT_EQ(facts->steps[1].problem, "x is too heavy");
  EXPECT_EQ(facts->steps[1].remedy, "balance it");
  ASSERT_EQ(facts->steps[1].findings.size(), 1U);
  EXPECT_EQ(facts->steps[1].findings[0].upper, 1.02);
}

TEST(ConsoleOperator, OrdersOfASession_AreRefusedByName) {
  Page page;
  for (const orders::Any& what :
       {orders::Any(orders::Arm{}), orders::Any(orders::LoadExercise{}), orders::Any(orders::Aim{}),
        orders::Any(orders::SetParameter{}), orders::Any(orders::LoadProfile{}),
        orders::Any(orders::TakeControls{}), orders::Any(orders::Spawn{})}) {
    const OrderReply reply = page.give(what);
    EXPECT_EQ(reply.refusal, Refusal::kNotHere);
    EXPECT_TRUE(reply.reason.starts_with(Order{what}.row().name)) << reply.reason;
  }
}

TEST(CommissioningRoles, OnlyTheTherapistWithTheControls_MayAnswerAndHoldTheKey) {
  Standing holder;
  holder.holds = true;
  for (const Order& order : {Order{orders::Answer{}}, Order{orders::HoldToMove{}}}) {
    EXPECT_TRUE(mayOrder(Role::kTherapist, order, holder).accepted);
    EXPECT_EQ(mayOrder(Role::kTherapist, order, {}).refusal, Refusal::kNotHolder);
    EXPECT_EQ(mayOrder(Role::kPlayer, order, holder).refusal, Refusal::kTherapistOnly);
    EXPECT_EQ(mayOrder(Role::kUnspecified, order, holder).refusal, Refusal::kTherapistOnly);
    EXPECT_EQ(mayOrder(Role::kWatcher, order, holder).refusal, Refusal::kOnlyWatches);
  }
}

}  // namespace
}  // namespace wholehand::test
