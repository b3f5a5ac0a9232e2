#include "station/server/websocket_words.hpp"

#include <initializer_list>

// A therapist, a player and a watcher over real WebSockets.
namespace wholehand::test {
namespace {

constexpr const char* kTherapist = "therapists-token-of-30-letters";
constexpr const char* kPlayer = "a-player-token-of-27-letters";
constexpr const char* kWatcher = "a-watcher-token-of-28-letter";

struct RolesTest : ServerTest {
  RolesTest() {
    SceneFacts facts;
    facts.exercise_name = "cocktail-bar";
    program.setScene(facts);
    show(RunState::kRendering, 1);
  }
  void show(RunState state, std::uint32_t endings, bool rested = false, std::uint32_t session = 1) {
    LoopStatus status;
    status.session = session;
    status.run_state = state;
    status.endings = endings;
    status.rested = rested;
    program.setStatus(status);
  }
  std::unique_ptr<WebSocket> client(const std::string& role, const char* token = nullptr) const {
    std::string target = "/ws?role=" + role;
    if (token != nullptr) target += std::string("&token=") + token;
    return std::make_unique<WebSocket>(port(), "", target);
  }
  /// A player that holds the controls; its next id is 2.
  std::unique_ptr<WebSocket> player() const {
    auto socket = client("player");
    socket->send(takeControls(1));
    EXPECT_EQ(answer(*socket).reason, "");
    return socket;
  }
  /// Sends one order and returns its answer.
  static replies::Answer ask(WebSocket& socket, const wire::Bytes& order) {
    socket.send(order);
    return answer(socket);
  }
  /// Waits until nobody holds the controls.
  bool comeFree() const {
    while (controls.holder() != 0) std::this_thread::sleep_for(1ms);
    return controls.holder() == 0;
  }
  struct Reported {
    bool mine = false, held = false, led = false;
    fb::Role role = fb::Role::Unspecified, holder = fb::Role::Unspecified;
  };
  static Reported controlsOf(WebSocket& socket) {
    const auto frame = next(socket, fb::Payload::Controls);
    if (!frame) return {};
    const auto* c = message(*frame).payload_as_Controls();
    return {c->held_by_you(), c->held(), c->led(), c->your_role(), c->holder_role()};
  }
};

TEST_F(RolesTest, TherapistWhileAPlayerHolds_IsObeyedInAllButSteering) {
  open();
  const auto plays = player();
  const auto leads = client("therapist");
  std::uint32_t id = 0;
  EXPECT_TRUE(ask(*leads, setParameter(++id, "lead_in_m", 0.25)).accepted);
  EXPECT_TRUE(ask(*leads, action(++id, fb::Act::Pause, 0)).accepted);
  EXPECT_TRUE(ask(*leads, load(++id, "cocktail-bar", 2, "")).accepted);
  EXPECT_TRUE(ask(*leads, stop(++id)).accepted);
  EXPECT_TRUE(ask(*leads, arm(++id)).accepted);
  EXPECT_EQ(ask(*leads, steer(++id, fb::Steering::Person)).refusal, fb::Refusal::NotHolder);
  EXPECT_EQ(program.askedFor<orders::SetParameter>(1).size(), 1U);
}

TEST_F(RolesTest, TherapistTakingTheSteering_GetsItAndThePlayerIsNotified) {
  open();
  const auto plays = player();
  const auto leads = client("therapist");
  EXPECT_TRUE(ask(*leads, takeControls(1)).accepted);
  Reported lost = controlsOf(*plays);
  while (lost.held && lost.holder == fb::Role::Player) lost = controlsOf(*plays);
  EXPECT_TRUE(lost.led);
  EXPECT_FALSE(lost.mine);
  EXPECT_EQ(lost.holder, fb::Role::Therapist);
  EXPECT_EQ(ask(*plays, aim(2, {0.1F})).refusal, fb::Refusal::NotHolder);
  EXPECT_EQ(ask(*plays, takeControls(3)).refusal, fb::Refusal::ControlsHeld);
  // The player's aim ends: the steering is set again (ADR 17).
  const auto steered = program.askedFor<orders::Steer>(1);
  ASSERT_EQ(steered.size(), 1U);
  EXPECT_EQ(steered[0].order.as<orders::Steer>()->by, Steering::kVirtualPatient);
  EXPECT_TRUE(ask(*leads, releaseControls(2)).accepted);
  EXPECT_TRUE(ask(*plays, takeControls(4)).accepted);
}

TEST_F(RolesTest, TwoTherapists_ShareAllOrdersAndTheLastOneSteers) {
  open();
  const auto one = client("therapist");
  const auto two = client("therapist");
  EXPECT_TRUE(ask(*one, takeControls(1)).accepted);
  EXPECT_TRUE(ask(*two, setParameter(1, "lead_in_m", 0.5)).accepted);
  EXPECT_TRUE(ask(*two, takeControls(2)).accepted);
  EXPECT_TRUE(ask(*one, setParameter(2, "lead_in_m", 0.4)).accepted);
  EXPECT_EQ(ask(*one, steer(3, fb::Steering::Person)).refusal, fb::Refusal::NotHolder);
  EXPECT_TRUE(ask(*two, steer(3, fb::Steering::Person)).accepted);
}

TEST_F(RolesTest, OrderOfTheTherapistFromAPlayer_IsRefusedWithAReason) {
  open();
  const auto leads = client("therapist");
  const auto plays = player();
  EXPECT_EQ(ask(*plays, setParameter(2, "lead_in_m", 0.25)).refusal, fb::Refusal::TherapistOnly);
  EXPECT_EQ(ask(*plays, load(3, "cocktail-bar", 2, "")).refusal, fb::Refusal::TherapistOnly);
  EXPECT_EQ(ask(*plays, arm(4)).refusal, fb::Refusal::TherapistOnly);
  EXPECT_TRUE(ask(*plays, steer(5, fb::Steering::Person)).accepted);
  EXPECT_TRUE(ask(*plays, aim(6, {0.1F})).accepted);
  EXPECT_TRUE(program.askedFor<orders::Arm>(1, 50ms).empty());
  EXPECT_EQ(refused("role"), 3.0);
}

TEST_F(RolesTest, PauseOfTheTherapist_LastsUntilTheTherapistEndsIt) {
  open();
  const auto leads = client("therapist");
  const auto plays = player();
  EXPECT_TRUE(ask(*leads, action(1, fb::Act::Pause, 0)).accepted);
  EXPECT_EQ(ask(*plays, action(2, fb::Act::Resume, 0)).refusal, fb::Refusal::TherapistPaused);
  EXPECT_TRUE(ask(*leads, action(2, fb::Act::Resume, 0)).accepted);
  EXPECT_TRUE(ask(*plays, action(3, fb::Act::Next, 0)).accepted);
  EXPECT_TRUE(ask(*leads, action(3, fb::Act::Pause, 0)).accepted);
  show(RunState::kRendering, 1, false, 2);
  EXPECT_TRUE(ask(*plays, action(4, fb::Act::Resume, 0)).accepted)
      << "the next session is not paused";
}

TEST_F(RolesTest, AnswerOfAnExercise_SaysWhetherATherapistGaveIt) {
  open();
  const auto leads = client("therapist");
  const auto plays = player();
  EXPECT_TRUE(ask(*plays, action(2, fb::Act::Next, 1, 1)).accepted);
  EXPECT_TRUE(ask(*leads, action(1, fb::Act::Next, 1, 2)).accepted);
  EXPECT_EQ(ask(*leads, action(2, fb::Act::Next, 1, 3)).refusal, fb::Refusal::Unreadable);
  const auto asked = program.askedFor<orders::Action>(2);
  ASSERT_EQ(asked.size(), 2U);
  EXPECT_EQ(asked[0].order.as<orders::Action>()->chosen, Choice::kFirst);
  EXPECT_FALSE(asked[0].order.as<orders::Action>()->by_therapist);
  EXPECT_EQ(asked[1].order.as<orders::Action>()->chosen, Choice::kSecond);
  EXPECT_TRUE(asked[1].order.as<orders::Action>()->by_therapist);
}

TEST_F(RolesTest, Watcher_SeesEverythingAndMayOnlyStop) {
  program.setRecord(busyRecord());
  open();
  const auto watches = client("watcher");
  EXPECT_EQ(controlsOf(*watches).role, fb::Role::Watcher);
  EXPECT_TRUE(next(*watches, fb::Payload::WorldState));
  EXPECT_EQ(ask(*watches, takeControls(1)).refusal, fb::Refusal::OnlyWatches);
  EXPECT_EQ(ask(*watches, stop(2)).refusal, fb::Refusal::OnlyWatches);
  EXPECT_TRUE(ask(*watches, emergencyStop(3)).accepted);
  EXPECT_EQ(program.askedFor<orders::EmergencyStop>(1).size(), 1U);
}

TEST_F(RolesTest, Player_LosesTheControlsAtAStopAndKeepsThemThroughALoad) {
  program.setRecord(busyRecord());
  open();
  const auto plays = player();
  show(RunState::kStopping, 1);  // a load: no ending
  ASSERT_TRUE(next(*plays, fb::Payload::WorldState));
  EXPECT_NE(controls.holder(), 0U);
  show(RunState::kStopped, 2);
  EXPECT_TRUE(comeFree());
  EXPECT_FALSE(controlsOf(*plays).mine);
}

TEST_F(RolesTest, Rest_CanBeEndedOnlyByTheSamePlayer) {
  open();
  const auto leads = client("therapist");
  const auto plays = player();
  EXPECT_TRUE(ask(*plays, rest(2)).accepted);
  const auto rests = program.askedFor<orders::Rest>(1);
  ASSERT_EQ(rests.size(), 1U);
  show(RunState::kStopped, 3, true);
  ASSERT_TRUE(comeFree()) << "its hand is off";
  const auto other = client("player");
  EXPECT_TRUE(ask(*other, takeControls(1)).accepted);
  EXPECT_EQ(ask(*other, armAcknowledging(3, 2)).refusal, fb::Refusal::TherapistOnly);
  EXPECT_TRUE(ask(*other, releaseControls(3)).accepted);
  EXPECT_TRUE(ask(*plays, takeControls(3)).accepted);
  EXPECT_EQ(ask(*plays, armAcknowledging(2, 4)).refusal, fb::Refusal::TherapistOnly) << "not seen";
  EXPECT_TRUE(ask(*plays, armAcknowledging(3, 5)).accepted);
  show(RunState::kStopped, 4, false);  // stopped by another client: not a rest
  EXPECT_EQ(ask(*plays, armAcknowledging(4, 6)).refusal, fb::Refusal::TherapistOnly);
}

TEST_F(RolesTest, ArmOfATherapistAfterAPlayerVanished_RestoresTheEffort) {
  open();
  player().reset();  // its line breaks
  const auto silent = program.askedFor<orders::HolderAlive>(1);
  ASSERT_EQ(silent.size(), 1U);
  EXPECT_FALSE(silent[0].order.as<orders::HolderAlive>()->alive);
  const auto leads = client("therapist");
  EXPECT_TRUE(ask(*leads, setParameter(1, "lead_in_m", 0.25)).accepted);
  EXPECT_EQ(program.askedFor<orders::HolderAlive>(2, 50ms).size(), 1U) << "only a start does";
  EXPECT_TRUE(ask(*leads, arm(2)).accepted);
  const auto alive = program.askedFor<orders::HolderAlive>(2);
  ASSERT_EQ(alive.size(), 2U);
  EXPECT_TRUE(alive[1].order.as<orders::HolderAlive>()->alive);
  EXPECT_LT(alive[1].at_ns, program.askedFor<orders::Arm>(1)[0].at_ns);
}

TEST_F(RolesTest, TokenOfEachRole_GrantsOnlyThatRole) {
  options.token = kTherapist;
  options.player_token = kPlayer;
  options.watcher_token = kWatcher;
  open();
  using fb::Role;
  struct Case {
    const char *claims, *token;
    Role gets;
  };
  for (const Case& c : std::initializer_list<Case>{{"therapist", kTherapist, Role::Therapist},
                                                   {"player", kTherapist, Role::Player},
                                                   {"player", kPlayer, Role::Player},
                                                   {"therapist", kPlayer, Role::Watcher},
                                                   {"player", kWatcher, Role::Watcher},
                                                   {"watcher", kWatcher, Role::Watcher},
                                                   {"watcher", kPlayer, Role::Watcher}}) {
    const auto socket = client(c.claims, c.token);
    EXPECT_EQ(controlsOf(*socket).role, c.gets) << c.claims << " with " << c.token;
  }
  WebSocket unsaid(port(), "", std::string("/ws?token=") + kPlayer);
  EXPECT_EQ(controlsOf(unsaid).role, Role::Player);
  EXPECT_EQ(client("therapist")->status(), 401);
  EXPECT_EQ(client("admin", kTherapist)->status(), 400);
}

TEST_F(RolesTest, InvalidTokens_AreRefusedByName) {
  const auto faults = [this] { return format(validate(options)); };
  options.player_token = kPlayer;
  EXPECT_NE(faults().find("player token: leaves nobody who may lead"), std::string::npos)
      << faults();
  options.token = kPlayer;
  EXPECT_NE(faults().find("player token: is the therapist's, too"), std::string::npos) << faults();
  options.token = kTherapist;
  options.watcher_token = kPlayer;
  EXPECT_NE(faults().find("watcher token: is the player's, too"), std::string::npos) << faults();
  options.watcher_token = "short";
  EXPECT_NE(faults().find("watcher token: is too short"), std::string::npos) << faults();
  options.watcher_token = kWatcher;
  EXPECT_EQ(faults(), "");
}

}  // namespace
}  // namespace wholehand::test
