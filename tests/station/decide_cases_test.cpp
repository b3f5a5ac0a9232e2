// What the station decides in single cases, one reason each: a guard of decide() that no other
// stands behind. Expected values: docs/protocol.md and docs/safety.md.
#include "station/decide.hpp"
#include "station/press_permit.hpp"

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

using Clock = std::chrono::steady_clock;
const auto kNow = Clock::time_point(std::chrono::hours(1));
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
  orders::Arm unseen = arm;
  unseen.acknowledged_stop = 0;
  const Prepare with_axis = [](StationState& s) {
    render(s);
    auto scene = facts();
    scene->device.axes.resize(1);
    s.scene = scene;
  };
  AxisPosition far(1);
  far[0] = 1e9;
  return {
      {"the program ends", Refusal::kEnding, [](StationState& s) { s.quit = true; },
       orders::SaveProfile{"a"}},
      {"the program has ended", Refusal::kEnding, [](StationState& s) { s.over = true; },
       orders::SaveProfile{"a"}},
      {"too many orders wait", Refusal::kTooMany,
       [](StationState& s) { s.waiting.resize(kMostWaitingOrders); }, orders::SaveProfile{"a"}},
      {"an action with nothing armed", Refusal::kNothingArmed, nothing,
       orders::Action{Act::kNext, 1}},
      {"an action that names no basis", Refusal::kOtherVersion, render,
       orders::Action{Act::kNext, 0}},
      {"a start that names no ending", Refusal::kOtherVersion, nothing, unseen},
      {"a start while a signal ends the program", Refusal::kStopCame,
       [](StationState& s) { s.interrupted = true; }, arm},
      {"a holder with nothing armed", Refusal::kNothingArmed, nothing, orders::HolderAlive{true}},
      {"an aim with nothing armed", Refusal::kNothingArmed, nothing, orders::Aim{}},
      {"steering with nothing armed", Refusal::kNothingArmed, nothing, orders::Steer{}},
      {"steering of a robot", Refusal::kOther, render, orders::Steer{}},
      {"a parameter that is not there", Refusal::kUnknownParameter, nothing,
       orders::SetParameter{"speed", 1.0, 1}},
      {"a parameter beyond its range", Refusal::kOutOfRange, nothing,
       orders::SetParameter{"force", 11.0, 1}},
      {"an aim of another size", Refusal::kNotAPosture, render, orders::Aim{AxisPosition(2)}},
      {"an aim far beyond the range", Refusal::kNotAPosture, with_axis, orders::Aim{far}},
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

using Replies = std::vector<OrderReply>;

Replies decided(StationState& state, const events::Any& event, Clock::time_point now = kNow) {
  Replies replies;
  for (const effects::Any& effect : decide(state, event, now)) {
    if (const auto* reply = std::get_if<effects::Reply>(&effect)) replies.push_back(reply->reply);
  }
  return replies;
}

bool isIdle(const StationState& state) {
  return std::holds_alternative<work::None>(state.work);
}

orders::Arm armed() {
  orders::Arm arm;
  arm.acknowledged_stop = arm.basis_seen = 1;
  return arm;
}

/// A station whose models are being rehearsed for a start.
StationState rehearsing(const Order& arm) {
  StationRules rules = clinicWithRobot();
  rules.rehearse = true;
  StationState state = idle(rules);
  (void)decided(state, events::Asked{arm});
  (void)decided(state, events::Turn{});
  EXPECT_TRUE(std::holds_alternative<work::Rehearse>(state.work));
  return state;
}

TEST(DecideRefusals, WorkThatFailed_EndsTheOrderWithItsReason) {
  const OrderReply failed = refused(Refusal::kFailed, "cannot be read");
  StationState state = idle();
  (void)decided(state, events::Asked{ordered(orders::LoadProfile{"a"})});
  (void)decided(state, events::Turn{});
  Replies replies = decided(state, events::ProfileRead{failed, models()});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].reason, failed.reason);
  EXPECT_TRUE(isIdle(state));

  (void)decided(state, events::Asked{ordered(orders::SaveProfile{"a"})});
  (void)decided(state, events::Turn{});
  replies = decided(state, events::ProfileSaved{failed});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].reason, failed.reason);
  EXPECT_EQ(state.profile, "");

  state = rehearsing(ordered(armed()));
  replies = decided(state, events::Rehearsed{failed});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].reason, failed.reason);
  EXPECT_TRUE(isIdle(state));
}

TEST(DecideRefusals, RehearsalThatAStopCancelled_IsAnsweredByTheStop) {
  StationState state = rehearsing(ordered(armed()));
  (void)decided(state, events::Asked{ordered(orders::Stop{})});
  const Replies replies = decided(state, events::Rehearsed{refused(Refusal::kFailed, "cancelled")});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].refusal, Refusal::kStopCame);
}

TEST(DecideRefusals, LoadWhoseRehearsalFails_IsRefusedAndKeepsTheModels) {
  StationRules rules = clinicWithRobot();
  rules.rehearse = true;
  StationState state = idle(rules);
  render(state);
  orders::LoadExercise load;
  load.level = 2;
  (void)decided(state, events::Asked{ordered(load)});
  (void)decided(state, events::Turn{});
  (void)decided(state, events::ModelsRead{kDone, facts(), models(), false});
  ASSERT_TRUE(std::holds_alternative<work::Rehearse>(state.work));
  const Replies replies = decided(state, events::Rehearsed{refused(Refusal::kFailed, "too heavy")});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].reason, "too heavy");
  EXPECT_EQ(state.run_state, RunState::kRendering);
  EXPECT_TRUE(isIdle(state));
}

// Before anything is prepared: the device is not asked for a press of half a minute ago.
TEST(DecideRefusals, RehearsalOfMoreThan30s_PreparesNothing) {
  Order arm = ordered(armed());
  const auto presser = std::make_shared<Requester>();
  presser->connected = true;
  arm.requester = presser;
  StationState state = rehearsing(arm);
  const auto late = kNow + PressPermit::kLongest + std::chrono::milliseconds(1);
  const Replies replies = decided(state, events::Rehearsed{kDone}, late);
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].refusal, Refusal::kWaitedTooLong);
  EXPECT_TRUE(isIdle(state));
}

// The same profile read again is the same hand and limits, but may be another person.
TEST(DecideRefusals, StartBehindAnotherClientsLoadOfTheSameProfile_IsRefused) {
  StationState state = idle();
  Order load = ordered(orders::LoadProfile{""});
  load.client = 2;
  (void)decided(state, events::Asked{load});
  (void)decided(state, events::Asked{ordered(armed())});
  (void)decided(state, events::Turn{});
  (void)decided(state, events::ProfileRead{kDone, models()});
  (void)decided(state, events::ModelsRead{kDone, facts(), models(), false});
  ASSERT_EQ(state.basis.number(), 1U);
  const Replies replies = decided(state, events::Turn{});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].refusal, Refusal::kOther);
}

/// A session that nobody joined ends, so that another one begins.
StationState renewing() {
  StationRules rules = clinicWithRobot();
  rules.rehearse = true;
  StationState state = idle(rules);
  render(state);
  state.began_at = kNow - rules.renew_after;
  (void)decided(state, events::RenewalDue{});
  EXPECT_TRUE(std::holds_alternative<work::EndSession>(state.work));
  return state;
}

TEST(DecideRefusals, RenewalOfASessionThatAFaultOrAStopEnds_StartsNothing) {
  StationState state = renewing();
  (void)decided(state, events::SessionEnded{false, Fault::kNone});
  EXPECT_FALSE(isIdle(state));  // else it goes on

  state = renewing();
  (void)decided(state, events::SessionEnded{true, Fault::kEncoderStuck});
  EXPECT_TRUE(isIdle(state));
  EXPECT_EQ(state.run_state, RunState::kFaulted);

  state = renewing();
  (void)decided(state, events::Asked{ordered(orders::Stop{})});
  (void)decided(state, events::SessionEnded{false, Fault::kNone});
  EXPECT_TRUE(isIdle(state));
}

TEST(DecideRefusals, StopWhileAFailedRecordingIsClosed_StartsNothingUnrecorded) {
  for (const bool stopped : {false, true}) {
    StationRules rules = clinicWithRobot();
    rules.records = true;
    StationState state = idle(rules);
    (void)decided(state, events::FirstStart{});
    (void)decided(state, events::Prepared{refused(Refusal::kCannotStart, "the disk is full")});
    ASSERT_TRUE(std::holds_alternative<work::CloseUnused>(state.work));
    if (stopped) (void)decided(state, events::Asked{ordered(orders::Stop{})});
    (void)decided(state, events::UnusedClosed{});
    EXPECT_EQ(isIdle(state), stopped);
  }
}

// The record of a visit holds what its person did, never a virtual patient's drink.
TEST(DecideStarts, SessionOfAVisit_IsPlayedByNobodyElse) {
  for (const std::uint64_t number : {0, 3}) {
    StationRules rules = clinicWithRobot();
    rules.robot = false;
    StationState state = idle(rules);
    state.visit.number = number;
    (void)decided(state, events::Asked{ordered(armed())});
    (void)decided(state, events::Turn{});
    (void)decided(state, events::Prepared{kDone});
    ASSERT_TRUE(state.live);
    EXPECT_EQ(state.steering, number != 0 ? Steering::kPerson : Steering::kVirtualPatient);
  }
}

template <class Effect>
bool follows(StationState& state, const events::Any& event) {
  for (const effects::Any& effect : decide(state, event, kNow)) {
    if (std::holds_alternative<Effect>(effect)) return true;
  }
  return false;
}

// A session is renewed only while nobody takes part in it and nobody asked for it.
TEST(DecideStarts, SessionWithSomebody_IsNotRenewed) {
  StationRules named = clinicWithRobot();
  named.record_named = true;
  const std::pair<StationRules, Prepare> all[] = {
      {named, render},
      {clinicWithRobot(), [](StationState& s) { render(s), s.armed_for_client = true; }},
      {clinicWithRobot(), [](StationState& s) { render(s), s.attended = true; }},
      {clinicWithRobot(), [](StationState& s) { render(s), s.run_state = RunState::kStopping; }},
      {clinicWithRobot(), [](StationState&) {}}};
  for (const auto& [rules, prepare] : all) {
    StationState state = idle(rules);
    prepare(state);
    state.began_at = kNow - rules.renew_after;
    (void)decided(state, events::RenewalDue{});
    EXPECT_TRUE(isIdle(state));
  }
}

TEST(DecideStarts, EndWithoutASession_EndsNothing) {
  StationState state = idle();
  EXPECT_FALSE(follows<effects::StopLoop>(state, events::EndDue{false}));
  EXPECT_TRUE(isIdle(state));
}

TEST(DecideStarts, RecordingOfNobody_IsDiscardedAndEveryOtherIsKept) {
  const auto discards = [](const Prepare& prepare, bool faulted) {
    StationState state = idle();
    render(state);
    prepare(state);
    return follows<effects::DiscardRecording>(state, events::LoopFinished{faulted, true});
  };
  EXPECT_TRUE(discards([](StationState&) {}, false));
  EXPECT_FALSE(discards([](StationState&) {}, true));
  EXPECT_FALSE(discards([](StationState& s) { s.attended = true; }, false));
  EXPECT_FALSE(discards([](StationState& s) { s.keep_recording = true; }, false));
  EXPECT_FALSE(discards([](StationState& s) { s.armed_for_client = true; }, false));
}

TEST(DecideStarts, LoadWhileRendering_UsesItsModelsWhenTheSessionHasEnded) {
  StationState state = idle();
  render(state);
  orders::LoadExercise load;
  load.level = 2;
  (void)decided(state, events::Asked{ordered(load)});
  (void)decided(state, events::Turn{});
  Profile second = models();
  second.level = 2;
  (void)decided(state, events::ModelsRead{kDone, facts(), second, false});
  ASSERT_TRUE(std::holds_alternative<work::EndSession>(state.work));
  EXPECT_TRUE(follows<effects::UseModels>(state, events::SessionEnded{false, Fault::kNone}));
  EXPECT_EQ(state.loaded.level, 2);
}

TEST(DecideStarts, ModelsThatPassed_AreNotRehearsedAgain) {
  StationState state = rehearsing(ordered(armed()));
  (void)decided(state, events::Rehearsed{kDone});
  EXPECT_TRUE(std::holds_alternative<work::Prepare>(state.work));
  StationState another = idle(*state.rules);
  another.rehearsed = true;
  (void)decided(another, events::Asked{ordered(armed())});
  (void)decided(another, events::Turn{});
  EXPECT_TRUE(std::holds_alternative<work::Prepare>(another.work));
}

// A client is told that the disk is full; nothing is rendered unrecorded behind its back.
TEST(DecideRefusals, StartOfAClientWithoutARecording_IsRefused) {
  StationRules rules = clinicWithRobot();
  rules.records = true;
  StationState state = idle(rules);
  (void)decided(state, events::Asked{ordered(armed())});
  (void)decided(state, events::Turn{});
  (void)decided(state, events::Prepared{refused(Refusal::kCannotStart, "the disk is full")});
  const Replies replies = decided(state, events::UnusedClosed{});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].refusal, Refusal::kCannotStart);
  EXPECT_TRUE(isIdle(state));
}

TEST(DecideRefusals, FirstStartThatAStopPrevents_IsAnsweredByItsNumber) {
  StationState state = idle();
  (void)decided(state, events::FirstStart{});
  (void)decided(state, events::Asked{ordered(orders::Stop{})});
  (void)decided(state, events::Prepared{kDone});
  bool answered = false;
  for (const effects::Any& effect : decide(state, events::UnusedClosed{}, kNow)) {
    const auto* reply = std::get_if<effects::Reply>(&effect);
    answered |= reply != nullptr && reply->asked == kFirstStart && !reply->reply.accepted;
  }
  EXPECT_TRUE(answered);
}

TEST(DecideRefusals, WorkThatThrows_EndsWhatIsUnderWayAndRestoresTheState) {
  StationState state = idle();
  EXPECT_TRUE(decided(state, events::WorkFailed{"nothing"}).empty());
  (void)decided(state, events::Asked{ordered(armed())});
  (void)decided(state, events::Turn{});
  ASSERT_TRUE(std::holds_alternative<work::Prepare>(state.work));
  (void)decided(state, events::WorkFailed{"no memory"});
  ASSERT_TRUE(std::holds_alternative<work::CloseUnused>(state.work));
  EXPECT_EQ(state.session, 0U);
  const Replies replies = decided(state, events::WorkFailed{"no file"});
  ASSERT_EQ(replies.size(), 1U);
  EXPECT_EQ(replies[0].reason, "failed: no memory");
  EXPECT_TRUE(isIdle(state));
}

TEST(DecideRefusals, NothingUnderWay_IsNoStart) {
  EXPECT_EQ(mayStillStart(idle(), kNow).refusal, Refusal::kStopCame);
}

}  // namespace
}  // namespace wholehand::test
