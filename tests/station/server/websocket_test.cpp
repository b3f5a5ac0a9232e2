#include "station/server/websocket_words.hpp"

#include <future>
#include <limits>

// Clients over real WebSockets: what they receive, which may command, and what is refused.
namespace wholehand::test {
namespace {

struct WebSocketTest : ServerTest {
  WebSocketTest() {
    SceneFacts facts;
    facts.program_version = "0.1";
    facts.exercise_name = "cocktail-bar";
    program.setScene(facts);
  }
  /// A client that holds the controls; its next id is 2.
  std::unique_ptr<WebSocket> holder() {
    auto socket = std::make_unique<WebSocket>(port());
    socket->send(takeControls(1));
    EXPECT_EQ(answer(*socket).reason, "");
    return socket;
  }
};

TEST_F(WebSocketTest, NewClient_GetsAWelcomeThenTheScene) {
  program.setRecord(busyRecord());
  open();
  WebSocket socket(port());
  ASSERT_EQ(socket.status(), 101);
  // The answer to the example key of RFC 6455, section 1.3.
  EXPECT_EQ(socket.reply().headers.at("sec-websocket-accept"), "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=");
  const auto welcome = socket.receive();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(message(*welcome).payload_as_Welcome()->schema_version(), wire::kSchemaVersion);
  EXPECT_GT(message(*welcome).payload_as_Welcome()->client(), 0U);
  EXPECT_EQ(message(*welcome).payload_as_Welcome()->program_version()->str(), "0.1");
  const auto scene = socket.receive();
  ASSERT_TRUE(scene);
  EXPECT_EQ(message(*scene).payload_as_Scene()->exercise_name()->str(), "cocktail-bar");
  const auto controls_message = socket.receive();
  ASSERT_TRUE(controls_message);
  EXPECT_FALSE(message(*controls_message).payload_as_Controls()->held());
  const auto state = socket.receive();
  ASSERT_TRUE(state);
  EXPECT_EQ(message(*state).payload_as_WorldState()->contacts()->size(), std::size_t{kMaxContacts});
}

TEST_F(WebSocketTest, PausedLoop_SendsChangesAndSignsOfLife) {
  program.setRecord(busyRecord());
  open();
  WebSocket socket(port());
  ASSERT_TRUE(next(socket, fb::Payload::WorldState));
  LoopStatus stopped;
  stopped.run_state = RunState::kStopped;
  program.setStatus(stopped);
  auto frame = next(socket, fb::Payload::WorldState, 300ms);
  ASSERT_TRUE(frame);  // the same tick, another run state
  EXPECT_EQ(message(*frame).payload_as_WorldState()->run_state(), fb::RunState::Stopped);
  EXPECT_TRUE(next(socket, fb::Payload::WorldState, 1s));  // repeated as a sign of life
}

TEST_F(WebSocketTest, ChangedScene_IsSentAgain) {
  open();
  WebSocket socket(port());
  ASSERT_TRUE(next(socket, fb::Payload::Scene));
  SceneFacts other;
  other.exercise_name = "free-grasping";
  program.setScene(other);
  const auto frame = next(socket, fb::Payload::Scene);
  ASSERT_TRUE(frame);
  EXPECT_EQ(message(*frame).payload_as_Scene()->exercise_name()->str(), "free-grasping");
}

TEST_F(WebSocketTest, EveryEvent_ArrivesInOrder) {
  open();
  WebSocket socket(port());
  ASSERT_TRUE(next(socket, fb::Payload::Controls));
  constexpr int kEvents = 2000;
  std::thread telemetry([&] {  // 4 events in each of 500 records, a record per ms
    TickRecord r;
    for (int i = 0; i < kEvents; ++i) {
      ExerciseEvent& e = r.exercise.events[r.exercise.event_count++];
      e.type = i % 16;
      e.value = i;
      if (r.exercise.event_count < 4) continue;
      ++r.tick;
      server->publish(r);
      r.exercise.event_count = 0;
      std::this_thread::sleep_for(1ms);
    }
  });
  int expected = 0;
  while (expected < kEvents) {
    const auto frame = next(socket, fb::Payload::Events);
    if (!frame) break;
    const auto* events = message(*frame).payload_as_Events()->events();
    for (const fb::Event* e : *events) {
      ASSERT_EQ(e->value(), static_cast<float>(expected));
      ASSERT_EQ(e->tick(), static_cast<std::uint64_t>(expected / 4 + 1));
      ++expected;
    }
  }
  telemetry.join();
  EXPECT_EQ(expected, kEvents);
}

TEST_F(WebSocketTest, SecondClient_WatchesAndMayOnlyStop) {
  open();
  const auto first = holder();
  WebSocket second(port());
  second.send(takeControls(1));
  const auto taken = answer(second);
  EXPECT_EQ(taken.reason, "another client holds the controls");
  EXPECT_EQ(taken.refusal, fb::Refusal::ControlsHeld);
  second.send(steer(2, fb::Steering::Person));
  const auto watching = answer(second);
  EXPECT_EQ(watching.reason, "this client does not hold the controls");
  EXPECT_EQ(watching.refusal, fb::Refusal::NotHolder);
  EXPECT_TRUE(program.askedFor<orders::Steer>(1, 50ms).empty());
  second.send(emergencyStop(3));
  const auto stopped = answer(second);
  EXPECT_TRUE(stopped.accepted);
  EXPECT_EQ(stopped.command, 3U);
  EXPECT_EQ(program.askedFor<orders::EmergencyStop>(1).size(), 1U);
  EXPECT_TRUE(logged("emergency stop"));
  EXPECT_EQ(refused("controls_held"), 1.0);
  EXPECT_EQ(refused("not_holder"), 1.0);
  EXPECT_TRUE(logged("another client holds the controls"));
}

TEST_F(WebSocketTest, Holder_IsReportedToAllAndMayCommand) {
  open();
  WebSocket watcher(port());
  ASSERT_TRUE(next(watcher, fb::Payload::Controls));
  const auto first = holder();
  const auto reported = next(watcher, fb::Payload::Controls);
  ASSERT_TRUE(reported);
  EXPECT_TRUE(message(*reported).payload_as_Controls()->held());
  EXPECT_FALSE(message(*reported).payload_as_Controls()->held_by_you());
  first->send(setParameter(2, "lead_in_m", 0.25));
  EXPECT_TRUE(answer(*first).accepted);
  const auto set = program.askedFor<orders::SetParameter>(1);
  ASSERT_EQ(set.size(), 1U);
  EXPECT_EQ(set[0].order.as<orders::SetParameter>()->name, "lead_in_m");
  EXPECT_EQ(set[0].order.as<orders::SetParameter>()->value, 0.25);
  first->send(setParameter(3, "lead_in_m", 2.0));  // refused by the program
  const auto above = answer(*first);
  EXPECT_EQ(above.reason, "lead_in_m = 2: must be in [0, 1]");
  EXPECT_EQ(above.refusal, fb::Refusal::OutOfRange);
  EXPECT_EQ(refused("order"), 1.0);
  first->send(load(4, "cocktail-bar", 2, ""));  // the answer comes later from another thread
  const auto loaded = answer(*first);
  EXPECT_EQ(loaded.command, 4U);
  EXPECT_TRUE(loaded.accepted);
  EXPECT_EQ(loaded.refusal, fb::Refusal::None);
  first->send(releaseControls(5));
  EXPECT_TRUE(answer(*first).accepted);
  const auto steered = program.askedFor<orders::Steer>(1);
  ASSERT_EQ(steered.size(), 1U);
  EXPECT_EQ(steered[0].order.as<orders::Steer>()->by, Steering::kVirtualPatient);
  EXPECT_EQ(controls.holder(), 0U);
}

/// Code and reason of the server's close frame.
std::pair<int, std::string> closing(WebSocket& client) {
  std::optional<WebSocket::Frame> frame;
  do frame = client.receive();
  while (frame && frame->opcode != 8);
  if (!frame || frame->payload.size() < 2) return {0, ""};
  client.sendFrame(8, frame->payload);
  return {static_cast<unsigned char>(frame->payload[0]) * 256 +
              static_cast<unsigned char>(frame->payload[1]),
          std::string(frame->payload.begin() + 2, frame->payload.end())};
}

// An answer could not name the order, so the connection is closed; a client that waits for one sees
// this.
TEST_F(WebSocketTest, UnreadableMessages_EndTheConnectionAndSayWhy) {
  open();
  wire::Bytes cut = steer(2, fb::Steering::Person);
  cut.resize(cut.size() - 6);
  const std::vector<std::pair<wire::Bytes, std::string>> bad = {
      {{1, 2, 3}, "message: is not one of Wholehand's"},
      {wire::Bytes(300, 0xFF), "message: is not one of Wholehand's"},
      {cut, "message: is damaged or cut short"}};
  for (const auto& [message, reason] : bad) {
    const auto client = holder();
    client->send(message);
    const auto reported = answer(*client);
    EXPECT_EQ(reported.command, 0U);
    EXPECT_EQ(reported.reason, reason);
    EXPECT_EQ(closing(*client), std::pair(1008, reason));
    for (int i = 0; i < 1000 && controls.holder() != 0; ++i) std::this_thread::sleep_for(5ms);
    EXPECT_EQ(controls.holder(), 0U);
  }
  WebSocket talker(port());
  talker.sendText("{\"order\":\"arm\"}");
  const auto text = answer(talker);
  EXPECT_EQ(text.reason, "this is text; messages are binary");
  EXPECT_EQ(text.refusal, fb::Refusal::Unreadable);
  EXPECT_EQ(closing(talker), std::pair(1008, text.reason));
  EXPECT_EQ(refused("malformed"), 3.0);
  EXPECT_EQ(refused("text"), 1.0);
  EXPECT_TRUE(program.askedFor<orders::Steer>(1, 0ms).empty() ||
              program.askedFor<orders::Steer>(1, 0ms)[0].order.client == 0);
}

// A page sends its heartbeats from another thread and may number them freely.
TEST_F(WebSocketTest, HeartbeatWithALargeId_DoesNotBlockLaterOrders) {
  open();
  const auto client = holder();
  client->send(heartbeat(4'000'000'000U));
  client->send(setParameter(2, "lead_in_m", 0.25));
  const auto obeyed = answer(*client);
  EXPECT_EQ(obeyed.command, 2U);
  EXPECT_TRUE(obeyed.accepted) << obeyed.reason;
}

TEST_F(WebSocketTest, BadMessages_AreRefusedAndChangeNothing) {
  open();
  const auto client = holder();
  const auto nan = std::numeric_limits<float>::quiet_NaN();
  client->send(aim(3, {0.0F, nan}));
  const auto aimed = answer(*client);
  EXPECT_NE(aimed.reason.find("not a finite number"), std::string::npos);
  EXPECT_EQ(aimed.command, 3U) << "its client waits for this number";
  client->send(arm(4, wire::kSchemaVersion + 1));
  const auto version = answer(*client);
  EXPECT_NE(version.reason.find("schema_version"), std::string::npos);
  EXPECT_EQ(version.refusal, fb::Refusal::OtherVersion);
  EXPECT_EQ(version.command, 4U);
  client->send(arm(5));
  EXPECT_TRUE(answer(*client).accepted);
  client->send(arm(5));  // a replayed id
  const auto again = answer(*client);
  EXPECT_EQ(again.reason, "command 5 came after command 5: their numbers must rise");
  EXPECT_EQ(again.refusal, fb::Refusal::Replayed);
  client->send(arm(3));
  EXPECT_NE(answer(*client).reason.find("must rise"), std::string::npos);
  EXPECT_EQ(program.askedFor<orders::Arm>(2, 50ms).size(), 1U);
  EXPECT_TRUE(program.askedFor<orders::Steer>(1, 0ms).empty());
  EXPECT_TRUE(program.askedFor<orders::Aim>(1, 0ms).empty());
  EXPECT_EQ(refused("malformed"), 1.0);
  EXPECT_EQ(refused("schema_version"), 1.0);
  EXPECT_EQ(refused("replayed"), 2.0);
  EXPECT_TRUE(logged("schema_version = 2"));
}

TEST_F(WebSocketTest,
       ReplayedEmergencyStop_IsObeyed) {  // an emergency stop is rather obeyed twice than ignored
  open();
  WebSocket client(port());
  client.send(emergencyStop(1));
  EXPECT_TRUE(answer(client).accepted);
  client.send(emergencyStop(1));
  EXPECT_TRUE(answer(client).accepted);
  EXPECT_EQ(program.askedFor<orders::EmergencyStop>(2).size(), 2U);
}

TEST_F(WebSocketTest, OversizedMessage_ClosesWith1009AndFreesTheControls) {
  open();
  const auto client = holder();
  client->send(wire::Bytes(wire::kLargestClientMessage + 1));
  std::optional<WebSocket::Frame> frame;
  do frame = client->receive();
  while (frame && frame->opcode != 8);
  ASSERT_TRUE(frame);
  ASSERT_GE(frame->payload.size(), 2U);
  const int code = static_cast<unsigned char>(frame->payload[0]) * 256 +
                   static_cast<unsigned char>(frame->payload[1]);
  EXPECT_EQ(code, 1009);
  client->sendFrame(8, frame->payload);
  const auto alive = program.askedFor<orders::HolderAlive>(1);
  ASSERT_FALSE(alive.empty());
  EXPECT_FALSE(alive[0].order.as<orders::HolderAlive>()->alive);
  EXPECT_EQ(refused("oversized"), 1.0);
  EXPECT_EQ(metric("dropped_clients_total{reason=\"oversized\"}"), 1.0);
  EXPECT_EQ(controls.holder(), 0U);
}

TEST_F(WebSocketTest, FloodOfMessages_IsDroppedExceptStops) {
  open();
  WebSocket client(port());
  client.send(takeControls(1));
  EXPECT_TRUE(answer(client).accepted);
  const auto began = std::chrono::steady_clock::now();
  for (std::uint32_t id = 2; id <= 600; ++id) client.send(heartbeat(id));
  client.send(stop(601));
  client.send(emergencyStop(602));
  EXPECT_EQ(answer(client).reason,
            "Heartbeat: more than 400 messages in a second, those beyond are dropped");
  for (const std::uint32_t id : {601U, 602U}) {
    const auto reply = answer(client);
    EXPECT_EQ(reply.command, id);
    EXPECT_TRUE(reply.accepted);
  }
  EXPECT_EQ(program.askedFor<orders::Stop>(1).size(), 1U);
  // The limit is 400 at once and 400 more a second, however slow the machine is.
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  EXPECT_GE(refused("rate"), 199.0 - 400.0 * took.count());
  EXPECT_LE(refused("rate"), 200.0);
}

// A client must not wait forever for an answer: each refused command is named.
TEST_F(WebSocketTest, CommandsBeyondTheRate_AreEachReportedByTheirId) {
  open();
  WebSocket client(port());
  for (std::uint32_t id = 1; id <= 600; ++id) client.send(heartbeat(id));
  (void)answer(client);  // the refusal of the heartbeats, which comes once
  for (const std::uint32_t id : {601U, 602U, 603U}) client.send(arm(id));
  for (const std::uint32_t id : {601U, 602U, 603U}) {
    const auto reply = answer(client);
    EXPECT_EQ(reply.command, id);
    EXPECT_FALSE(reply.accepted);
    if (reply.reason == "this client does not hold the controls") continue;  // on a slow machine
    EXPECT_EQ(reply.reason, "Arm: more than 400 messages in a second, those beyond are dropped");
  }
}

TEST_F(WebSocketTest, ForeignOrigin_GetsNoConnection) {
  options.allowed_origins = {"https://clinic.example"};
  open();
  const std::string own = std::to_string(port());
  for (const std::string& origin :
       {std::string("http://evil.example"), "http://localhost.evil.example:" + own,
        "http://localhost:1" + own, std::string("null"), "file://localhost:" + own}) {
    EXPECT_EQ(WebSocket(port(), "Origin: " + origin + "\r\n").status(), 403) << origin;
  }
  for (const std::string& origin : {"http://localhost:" + own, "http://127.0.0.1:" + own,
                                    "http://[::1]:" + own, std::string("https://clinic.example")}) {
    EXPECT_EQ(WebSocket(port(), "Origin: " + origin + "\r\n").status(), 101) << origin;
  }
  EXPECT_EQ(WebSocket(port(), "Host: evil.example\r\nOrigin: http://evil.example\r\n").status(),
            421);
  // Through a forwarded port, the host as the browser knows it counts.
  EXPECT_EQ(WebSocket(port(), "Host: localhost:9\r\nOrigin: http://localhost:9\r\n").status(), 101);
  EXPECT_EQ(refused("origin"), 5.0);
  EXPECT_TRUE(logged("refused (origin)"));
}

TEST_F(WebSocketTest, Token_IsRequiredForConnectionsAndControls) {
  options.token = "a-token-of-twenty-ch";
  open();
  EXPECT_EQ(WebSocket(port()).status(), 401);
  EXPECT_EQ(WebSocket(port(), "", "/ws?token=wrong").status(), 401);
  WebSocket client(port(), "", "/ws?token=a-token-of-twenty-ch");
  ASSERT_EQ(client.status(), 101);
  EXPECT_NE(client.reply()
                .headers.at("set-cookie")
                .find("wholehand_token_" + std::to_string(port()) + "="),
            std::string::npos);
  client.send(takeControls(1, "a-token-of-twenty-cx"));
  const auto wrong = answer(client);
  EXPECT_EQ(wrong.reason, "the token is wrong");
  EXPECT_EQ(wrong.refusal, fb::Refusal::WrongToken);
  client.send(takeControls(2, "a-token-of-twenty-ch"));
  EXPECT_TRUE(answer(client).accepted);
  EXPECT_EQ(refused("token"), -1.0);  // /metrics needs the token, too
  EXPECT_TRUE(logged("refused (token)"));
}

// Sixteen clients that never read, or sixteen tabs, must not keep a therapist out.
TEST_F(WebSocketTest, NewClientWithAllPlacesTaken_ReplacesTheFirstThatHoldsNothing) {
  options.max_clients = 3;
  open();
  const auto holds = holder();
  WebSocket a(port()), b(port());
  ASSERT_TRUE(a.receive());
  ASSERT_TRUE(b.receive());
  for (int i = 0; i < 30; ++i) {
    WebSocket newcomer(port());
    ASSERT_EQ(newcomer.status(), 101);
    ASSERT_TRUE(newcomer.receive());
    ASSERT_LE(metric("clients"), 3.0);
  }
  holds->send(emergencyStop(2));  // still connected and obeyed
  EXPECT_EQ(program.askedFor<orders::EmergencyStop>(1).size(), 1U);
}

// All clients ask before the first one is admitted.
TEST_F(WebSocketTest, TooManyClientsAtOnce_NeverExceedTheLimit) {
  options.max_clients = 2;
  options.more_metrics = [] {  // blocks the server's thread while the requests arrive
    std::this_thread::sleep_for(300ms);
    return std::string();
  };
  open();
  std::vector<std::unique_ptr<RawSocket>> many;
  for (int i = 0; i < 20; ++i) many.push_back(std::make_unique<RawSocket>(port()));
  ASSERT_EQ(get(port(), "/healthz").status, 200);  // the server accepts them
  RawSocket metrics(port());
  metrics.send("GET /metrics HTTP/1.1\r\nHost: localhost\r\n\r\n");
  std::this_thread::sleep_for(50ms);
  for (const auto& socket : many) {
    socket->send(
        "GET /ws HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
  }
  int connected = 0;
  for (const auto& socket : many) {
    const auto reply = socket->receiveUntil("\r\n", kPatience);
    ASSERT_TRUE(reply);
    if (reply->find(" 101 ") != std::string::npos) ++connected;
  }
  EXPECT_GE(connected, 2);
  EXPECT_LE(metric("clients"), 2.0);
}

TEST_F(WebSocketTest, BlockedLog_DelaysNoEmergencyStop) {
  std::promise<void> released;
  auto moves_on = released.get_future().share();
  options.log = [moves_on](const std::string&) {
    moves_on.wait();
  };  // blocks like a stopped terminal
  open();
  const auto client = holder();  // taking the controls is logged
  client->send(emergencyStop(2));
  EXPECT_EQ(program.askedFor<orders::EmergencyStop>(1).size(), 1U);
  released.set_value();
}

// load_test.cpp measures the time.
TEST_F(WebSocketTest, SilentHolder_LosesTheControlsUntilItTakesThemAnew) {
  open();
  const auto client = holder();
  auto alive = program.askedFor<orders::HolderAlive>(1);
  ASSERT_GE(alive.size(), 1U);
  EXPECT_FALSE(alive[0].order.as<orders::HolderAlive>()->alive);
  while (controls.holder() != 0) std::this_thread::sleep_for(1ms);
  EXPECT_TRUE(logged("was silent and lost the controls"));
  client->send(heartbeat(0));  // heartbeats have no number: not refused, without effect
  client->send(aim(3, {0.0F}));
  EXPECT_EQ(answer(*client).refusal, fb::Refusal::NotHolder);
  EXPECT_EQ(program.askedFor<orders::HolderAlive>(1).size(), 1U);
  client->send(takeControls(4));
  EXPECT_TRUE(answer(*client).accepted);
  alive = program.askedFor<orders::HolderAlive>(2);
  ASSERT_GE(alive.size(), 2U);
  EXPECT_TRUE(alive[1].order.as<orders::HolderAlive>()->alive);
}

TEST_F(WebSocketTest, VanishedHolder_FadesTheEffortAtOnce) {
  open();
  auto client = holder();
  const std::int64_t gone_ns = monotonicNow_ns();
  client.reset();
  const auto alive = program.askedFor<orders::HolderAlive>(1);
  ASSERT_EQ(alive.size(), 1U);
  EXPECT_FALSE(alive.back().order.as<orders::HolderAlive>()->alive);
  // Silence alone would be noticed after 200 ms at the earliest.
  EXPECT_LE(alive.back().at_ns - gone_ns, 100'000'000);
  EXPECT_EQ(controls.holder(), 0U);  // free for the next client, such as its own reconnection
  EXPECT_TRUE(logged("left while it held the controls"));
}

// A busy page is as silent as one that says nothing: its effort fades, and nothing is armed for it.
TEST_F(WebSocketTest, BusyHolder_FadesTheEffortAndIsNotHeard) {
  open();
  const auto client = holder();
  client->send(setParameter(2, "lead_in_m", 0.25));
  const auto order = program.askedFor<orders::SetParameter>(1).at(0).order;
  const std::int64_t heard_ns = order.requester->heard_ns;
  std::vector<FakeProgram::ReceivedOrder> alive;
  for (int i = 0; i < 200 && alive.empty(); ++i) {
    client->send(heartbeat(0, true));
    alive = program.askedFor<orders::HolderAlive>(1, 20ms);
  }
  ASSERT_FALSE(alive.empty());
  EXPECT_FALSE(alive[0].order.as<orders::HolderAlive>()->alive);
  EXPECT_EQ(order.requester->heard_ns, heard_ns);
  client->send(heartbeat(0));
  alive = program.askedFor<orders::HolderAlive>(2);
  ASSERT_GE(alive.size(), 2U);
  EXPECT_TRUE(alive[1].order.as<orders::HolderAlive>()->alive);
  EXPECT_GT(order.requester->heard_ns, heard_ns);
}

TEST_F(WebSocketTest, ProgramThatThrows_LosesNoClient) {
  open();
  const auto client = holder();
  client->send(setParameter(2, "throw", 0.5));
  WebSocket other(port());
  EXPECT_TRUE(next(other, fb::Payload::WorldState));
  EXPECT_EQ(get(port(), "/healthz").status, 200);
  EXPECT_TRUE(logged("the server went on after: asked for"));
}

TEST_F(WebSocketTest, AnswerAfterTheServersEnd_IsDroppedSafely) {
  open();
  {
    const auto client = holder();
    for (std::uint32_t id = 2; id < 30; ++id) client->send(load(id, "cocktail-bar", 1, ""));
    (void)program.askedFor<orders::LoadExercise>(20);
    server.reset();
  }
  EXPECT_GE(program.askedFor<orders::LoadExercise>(1).size(), 1U);
  std::this_thread::sleep_for(20ms);  // its threads finish
}

}  // namespace
}  // namespace wholehand::test
