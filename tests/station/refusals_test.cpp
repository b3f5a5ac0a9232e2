// What the station refuses at once, one reason each: a guard of decide() that no other stands
// behind. Expected values: docs/protocol.md and docs/safety.md.
#include "station/decide.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace wholehand::test {
namespace {

const auto kNow = std::chrono::steady_clock::time_point(std::chrono::hours(1));
const OrderReply kDone{true, ""};

std::shared_ptr<SceneFacts> facts() {
  auto scene = std::make_shared<SceneFacts>();
  scene->hand.name = "right";
  scene->parameters.push_back(
      {"force", ParameterGroup::kPatient, "N", 0.0, 10.0, 10.0, 10.0, true});
  return scene;
}

Profile models() {
  Profile loaded;
  loaded.device = "robot";
  loaded.hand = loaded.side = "right";
  loaded.exercise = "bar";
  loaded.level = 1;
  return loaded;
}

StationRules clinicWithRobot() {
  StationRules rules;
  rules.rehearse = false;
  rules.robot = rules.clinic = true;
  return rules;
}

/// A station where nothing is armed.
StationState idle(const StationRules& rules = clinicWithRobot()) {
  StationState state(std::make_shared<const StationRules>(rules));
  state.scene = facts();
  state.loaded = models();
  return state;
}

void render(StationState& state) {
  state.live = state.began = true;
  state.run_state = RunState::kRendering;
}

/// What the main thread's work brings; the profile that is read is `stored`.
OrderReply answerOf(StationState& state, const Order& order, const Profile& stored = models()) {
  OrderReply answer{true, "not answered"};
  const std::uint64_t number = state.orders + 1;
  const auto decideOn = [&](const events::Any& event) {
    for (const effects::Any& effect : decide(state, event, kNow)) {
      const auto* reply = std::get_if<effects::Reply>(&effect);
      if (reply != nullptr && reply->asked == number) answer = reply->reply;
    }
  };
  decideOn(events::Asked{order});
  decideOn(events::Turn{});
  if (std::holds_alternative<work::ReadProfile>(state.work)) {
    decideOn(events::ProfileRead{kDone, stored});
  }
  if (std::holds_alternative<work::ReadModels>(state.work)) {
    decideOn(events::ModelsRead{kDone, facts(), models(), false});
  }
  return answer;
}

Order ordered(orders::Any what) {
  Order order;
  order.what = std::move(what);
  order.client = 1;
  return order;
}

orders::OpenVisit visit(std::uint64_t number) {
  orders::OpenVisit open;
  open.visit = number;
  open.exercise = "bar";
  open.hand = "right";
  return open;
}

using Prepare = std::function<void(StationState&)>;
struct Case {
  std::string why;
  Refusal refusal;
  Prepare prepare;
  orders::Any what;
};

std::vector<Case> allCases() {
  const Prepare nothing = [](StationState&) {};
  const Prepare in_visit = [](StationState& s) { s.visit.number = 3; };
  const Prepare stopping = [](StationState& s) {
    render(s);
    s.run_state = RunState::kStopping;
  };
  orders::OpenVisit no_exercise = visit(7), no_hand = visit(7), elsewhere = visit(7),
                    unknown = visit(7), beyond = visit(7);
  no_exercise.exercise.clear();
  no_hand.hand.clear();
  elsewhere.hand.clear();
  elsewhere.hand_file = "../right.toml";
  unknown.parameters = {{"speed", 1.0}};
  beyond.parameters = {{"force", 11.0}};
  orders::LoadExercise left;
  left.hand = "left";
  orders::Arm arm;
  arm.acknowledged_stop = arm.basis_seen = 1;
  return {
      {"the program ends", Refusal::kEnding, [](StationState& s) { s.quit = true; },
       orders::SaveProfile{"a"}},
      {"the program has ended", Refusal::kEnding, [](StationState& s) { s.over = true; },
       orders::SaveProfile{"a"}},
      {"too many orders wait", Refusal::kTooMany,
       [](StationState& s) { s.waiting.resize(kMostWaitingOrders); }, orders::SaveProfile{"a"}},
      {"an action with nothing armed", Refusal::kNothingArmed, nothing,
       orders::Action{Act::kNext, 1}},
      {"an aim with nothing armed", Refusal::kNothingArmed, nothing, orders::Aim{}},
      {"steering with nothing armed", Refusal::kNothingArmed, nothing, orders::Steer{}},
      {"steering of a robot", Refusal::kOther, render, orders::Steer{}},
      {"a parameter that is not there", Refusal::kUnknownParameter, nothing,
       orders::SetParameter{"speed", 1.0, 1}},
      {"a parameter beyond its range", Refusal::kOutOfRange, nothing,
       orders::SetParameter{"force", 11.0, 1}},
      {"an aim of another size", Refusal::kNotAPosture, render, orders::Aim{AxisPosition(2)}},
      {"a profile without an exercise", Refusal::kOther,
       [](StationState& s) { s.loaded.exercise.clear(); }, orders::SaveProfile{"a"}},
      {"a profile saved in a visit", Refusal::kVisitOpen, in_visit, orders::SaveProfile{"a"}},
      {"a profile loaded while armed", Refusal::kArmedAlready, render, orders::LoadProfile{"a"}},
      {"a profile loaded in a visit", Refusal::kVisitOpen, in_visit, orders::LoadProfile{"a"}},
      {"another hand in a visit", Refusal::kVisitOpen, in_visit, left},
      {"a visit opened while armed", Refusal::kArmedAlready, render, visit(7)},
      {"a visit without a number", Refusal::kOther, nothing, visit(0)},
      {"a visit beside another", Refusal::kVisitOpen, in_visit, visit(7)},
      {"a visit without an exercise", Refusal::kOther, nothing, no_exercise},
      {"a visit without a hand", Refusal::kUnknownHand, nothing, no_hand},
      {"a hand file elsewhere", Refusal::kUnknownHand, nothing, elsewhere},
      {"a visit that sets what is not there", Refusal::kUnknownParameter, nothing, unknown},
      {"a visit that sets beyond a range", Refusal::kOutOfRange, nothing, beyond},
      {"another visit closed", Refusal::kVisitOpen, in_visit, orders::CloseVisit{7}},
      {"a visit closed while armed", Refusal::kArmedAlready,
       [&](StationState& s) {
         render(s);
         s.visit.number = 3;
       },
       orders::CloseVisit{3}},
      {"armed already", Refusal::kArmedAlready, render, arm},
      {"armed while it stops", Refusal::kStillStopping, stopping, arm},
  };
}

TEST(DecideRefusals, EachReason_IsNamedAndChangesNothing) {
  for (const Case& c : allCases()) {
    StationState state = idle();
    c.prepare(state);
    const RunState before = state.run_state;
    const OrderReply answer = answerOf(state, ordered(c.what));
    EXPECT_FALSE(answer.accepted) << c.why << ": " << answer.reason;
    EXPECT_EQ(answer.refusal, c.refusal) << c.why << ": " << answer.reason;
    EXPECT_EQ(state.run_state, before) << c.why;
    EXPECT_TRUE(std::holds_alternative<work::None>(state.work)) << c.why;
  }
}

TEST(DecideRefusals, VisitWithoutRecords_IsRefused) {
  StationRules rules = clinicWithRobot();
  rules.clinic = false;
  StationState state = idle(rules);
  EXPECT_EQ(answerOf(state, ordered(visit(7))).refusal, Refusal::kNotHere);
}

TEST(DecideRefusals, ProfileOfAnotherDeviceOrSide_IsRefused) {
  for (std::string Profile::*const of : {&Profile::device, &Profile::side}) {
    StationState state = idle();
    Profile stored = models();
    stored.*of = "another";
    EXPECT_EQ(answerOf(state, ordered(orders::LoadProfile{"a"}), stored).refusal,
              Refusal::kOtherProfile);
  }
}

TEST(DecideRefusals, BodiesOfAFormerHolderOrWhileTheLoopStops_AreRefused) {
  Order order = ordered(orders::Spawn{});
  order.claim = 1;
  StationState state = idle();
  state.claim = 2;
  EXPECT_EQ(acceptBodies(state, order).refusal, Refusal::kNotHolder);
  state.claim = 1;
  EXPECT_TRUE(acceptBodies(state, order).accepted);
  render(state);
  EXPECT_TRUE(acceptBodies(state, order).accepted);
  state.run_state = RunState::kStopping;
  EXPECT_EQ(acceptBodies(state, order).refusal, Refusal::kStillStopping);
}

TEST(DecideRefusals, OnlyWhatPeopleOrder_CountsAsTakingPart) {
  StationRules rules = clinicWithRobot();
  rules.robot = false;
  const std::pair<orders::Any, bool> all[] = {{orders::Steer{Steering::kVirtualPatient}, false},
                                              {orders::HolderAlive{true}, false},
                                              {orders::Unattended{}, false},
                                              {orders::Steer{Steering::kPerson}, true},
                                              {orders::SetHelp{Help::kFull}, true}};
  for (const auto& [what, takes_part] : all) {
    StationState state = idle(rules);
    render(state);
    (void)answerOf(state, ordered(what));
    EXPECT_EQ(state.attended, takes_part) << what.index();
  }
}

TEST(DecideRefusals, StartUnderWay_IsShownAsArming) {
  StationState state = idle();
  LoopStatus status;
  describe(state, kNow, status);
  EXPECT_FALSE(status.arming);
  orders::Arm arm;
  arm.acknowledged_stop = arm.basis_seen = 1;
  (void)decide(state, events::Asked{ordered(arm)}, kNow);
  (void)decide(state, events::Turn{}, kNow);
  ASSERT_TRUE(state.starting);
  describe(state, kNow, status);
  EXPECT_TRUE(status.arming);
}

}  // namespace
}  // namespace wholehand::test
