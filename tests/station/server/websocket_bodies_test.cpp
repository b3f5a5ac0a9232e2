#include "station/server/sample_facts.hpp"
#include "station/server/websocket_words.hpp"

// Orders to the bodies of a game over real WebSockets: which clients may send them and what clients
// receive.
namespace wholehand::test {
namespace {

struct BodiesTest : ServerTest {
  std::unique_ptr<WebSocket> client(const std::string& role) const {
    return std::make_unique<WebSocket>(port(), "", "/ws" + role);
  }
  static replies::Answer ask(WebSocket& socket, const wire::Bytes& order) {
    socket.send(order);
    return answer(socket);
  }
  static std::vector<wire::Bytes> orders(std::uint32_t first) {
    return {prepareBall(first, 0, 0.03F),
            spawn(first + 1, {{}}),
            words::remove(first + 2, {{0, 1}}),
            teleport(first + 3, {{0, 1, placed(0.4F, 0, 0)}}),
            setOwner(first + 4, {{0, 1, fb::BodyOwner::Game}}),
            bodyTargets(first + 5, {{0, 1, placed(0.4F, 0, 0)}})};
  }
  /// Shows clients a ball in slot 3.
  void show(SlotState state) {
    if (!shapes) {
      GameShapes ball = sampleBall();
      ball.pieces[0].in_body.translation_m = {0.0, 0.0, 0.01};
      shapes = std::make_shared<const GameShapes>(ball);
    }
    LoopStatus status;
    status.session = 4;
    GameBodies bodies;
    if (state != SlotState::kParked) bodies.push_back({3, 9, state, shapes});
    status.bodies = std::make_shared<const GameBodies>(bodies);
    status.registered = registered;
    program.setStatus(status);
  }
  void showRegistered(const RegisteredBodies& bodies) {
    registered = std::make_shared<const RegisteredBodies>(bodies);
    show(SlotState::kSolid);
  }

  std::shared_ptr<const GameShapes> shapes;
  std::shared_ptr<const RegisteredBodies> registered;
};

TEST_F(BodiesTest, OnlyTheHolderOfTheControls_OrdersBodies) {
  open();
  const auto holds = client("");
  ASSERT_TRUE(ask(*holds, takeControls(1)).accepted);
  for (const auto& order : orders(2)) EXPECT_TRUE(ask(*holds, order).accepted);
  EXPECT_EQ(program.askedFor<orders::PrepareShapes>(1).size(), 1U);
  EXPECT_EQ(program.askedForBodies(5).size(), 5U);
  const auto refuses = [&](const char* role, fb::Refusal refusal) {
    const auto other = client(role);
    for (const auto& order : orders(1)) EXPECT_EQ(ask(*other, order).refusal, refusal) << role;
  };
  refuses("", fb::Refusal::NotHolder);
  refuses("?role=player", fb::Refusal::NotHolder);
  refuses("?role=therapist", fb::Refusal::NotHolder);
  refuses("?role=watcher", fb::Refusal::OnlyWatches);
  EXPECT_EQ(program.askedForBodies(5).size(), 5U);
}

TEST_F(BodiesTest, CountsBeyondAnyScene_AreRefusedWithoutAskingTheProgram) {
  open();
  const auto holds = client("");
  ASSERT_TRUE(ask(*holds, takeControls(1)).accepted);
  const std::vector<fb::BodyName> many(65, fb::BodyName(0, 1));
  const std::vector<wire::Bytes> bad = {
      words::remove(2, many), words::remove(3, {}), spawn(4, {}),
      prepareShapes(5, 0, [](Builder&) { return std::vector<flatbuffers::Offset<fb::Shape>>(); })};
  for (const auto& order : bad) {
    const auto reply = ask(*holds, order);
    EXPECT_EQ(reply.refusal, fb::Refusal::Unreadable);
    EXPECT_NE(reply.reason.find("must be in [1, "), std::string::npos) << reply.reason;
  }
  EXPECT_TRUE(program.askedForBodies(1, 0ms).empty());
}

TEST_F(BodiesTest, LargestShapes_ArePassedOnAndCountAsSeveralMessages) {
  open();
  const auto holds = client("");
  ASSERT_TRUE(ask(*holds, takeControls(1)).accepted);
  const auto largest = [](std::uint32_t id) {
    return prepareShapes(id, 0, [](Builder& b) {
      const std::vector<fb::Vec3> points(kMaxPieceVertices);
      const std::vector<std::uint32_t> triangles(3 * (2 * kMaxPieceVertices - 4));
      std::vector<flatbuffers::Offset<fb::Shape>> out;
      for (int i = 0; i < kMaxSlotPieces; ++i) {
        out.push_back(fb::CreateShapeDirect(b, fb::ShapeType::ConvexMesh, nullptr, 0.0F, 0.0F,
                                            &points, &triangles));
      }
      return out;
    });
  };
  figure("largest shapes", static_cast<double>(largest(2).size()), "bytes");
  EXPECT_LE(largest(2).size(), wire::kLargestClientMessage);
  constexpr int kSent = 120;
  const auto began = std::chrono::steady_clock::now();
  // A client that does not read is cut off after two seconds.
  const auto readAll = [&holds] {
    while (holds->receive(0ms)) {
    }
  };
  for (std::uint32_t id = 2; id < 2 + kSent; ++id) {
    holds->send(largest(id));
    readAll();
  }
  double dropped = 0.0, passed = 0.0;
  const auto until = began + kPatience;
  while (dropped + passed < kSent && std::chrono::steady_clock::now() < until) {
    readAll();
    dropped = std::max(0.0, refused("rate"));
    // On a busy machine the test may be silent for 200 ms and lose the controls.
    passed = static_cast<double>(program.askedFor<orders::PrepareShapes>(0).size()) +
             std::max(0.0, refused("not_holder"));
  }
  EXPECT_EQ(dropped + passed, kSent);
  // A message of 36.6 kB counts as nine: 400 a second allow 44 at once and 44.4 more a second,
  // however slow the machine is.
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  EXPECT_LE(passed, 45.0 + 400.0 / 9.0 * took.count());
  EXPECT_GE(passed, 43.0);
}

TEST_F(BodiesTest, BodiesOfAGame_AreReportedOnChangeAndToNewClients) {
  open();
  const auto first = client("?role=watcher");
  ASSERT_TRUE(next(*first, fb::Payload::Controls));
  show(SlotState::kGhost);
  const auto ghost = next(*first, fb::Payload::GameBodies);
  ASSERT_TRUE(ghost);
  const auto* reported = message(*ghost).payload_as_GameBodies();
  EXPECT_EQ(reported->session(), 4U);
  ASSERT_EQ(reported->bodies()->size(), 1U);
  EXPECT_EQ(reported->bodies()->Get(0)->slot(), 3U);
  EXPECT_EQ(reported->bodies()->Get(0)->generation(), 9U);
  EXPECT_EQ(reported->bodies()->Get(0)->shapes(), 11U);
  EXPECT_EQ(reported->bodies()->Get(0)->state(), fb::SlotState::Ghost);
  ASSERT_EQ(reported->new_shapes()->size(), 1U);
  EXPECT_EQ(reported->new_shapes()->Get(0)->id(), 11U);
  EXPECT_FLOAT_EQ(reported->new_shapes()->Get(0)->com_m()->z(), 0.01F);
  const auto* piece = reported->new_shapes()->Get(0)->pieces()->Get(0);
  EXPECT_FLOAT_EQ(piece->radius_m(), 0.03F);
  EXPECT_EQ(piece->in_body()->position_m().z(), 0.0F) << "about the centre of mass";
  show(SlotState::kSolid);
  const auto solid = next(*first, fb::Payload::GameBodies);
  ASSERT_TRUE(solid);
  reported = message(*solid).payload_as_GameBodies();
  EXPECT_EQ(reported->bodies()->Get(0)->state(), fb::SlotState::Solid);
  EXPECT_EQ(reported->new_shapes()->size(), 0U) << "known from the message before";
  const auto later = client("?role=watcher");
  const auto joined = next(*later, fb::Payload::GameBodies);
  ASSERT_TRUE(joined);
  reported = message(*joined).payload_as_GameBodies();
  EXPECT_EQ(reported->bodies()->Get(0)->state(), fb::SlotState::Solid);
  EXPECT_EQ(reported->new_shapes()->size(), 1U);
  show(SlotState::kParked);
  const auto none = next(*first, fb::Payload::GameBodies);
  ASSERT_TRUE(none);
  EXPECT_EQ(message(*none).payload_as_GameBodies()->bodies()->size(), 0U);
}

TEST_F(BodiesTest, RegisteredBodies_AreReportedByChangesAndCompletelyToNewClients) {
  open();
  const auto first = client("?role=watcher");
  ASSERT_TRUE(next(*first, fb::Payload::Controls));
  show(SlotState::kSolid);
  ASSERT_TRUE(next(*first, fb::Payload::GameBodies));
  RegisteredBody away{1000, 5, -1, Whereabouts::kOutOfReach, {{1, 2, 3}, {}}, shapes};
  RegisteredBody near{1001, 6, 3, Whereabouts::kInSlot, {{0, 0, 0}, {}}, shapes};
  showRegistered({away, near});
  const auto both = next(*first, fb::Payload::GameBodies);
  ASSERT_TRUE(both);
  const auto* reported = message(*both).payload_as_GameBodies();
  ASSERT_EQ(reported->registered()->size(), 2U);
  EXPECT_EQ(reported->registered()->Get(0)->number(), 1000U);
  EXPECT_EQ(reported->registered()->Get(0)->generation(), 5U);
  EXPECT_EQ(reported->registered()->Get(0)->shapes(), 11U);
  EXPECT_EQ(reported->registered()->Get(0)->slot(), -1);
  EXPECT_EQ(reported->registered()->Get(0)->whereabouts(), fb::Whereabouts::OutOfReach);
  EXPECT_EQ(reported->registered()->Get(0)->pose().position_m().z(), 3.0F);
  EXPECT_EQ(reported->registered()->Get(1)->slot(), 3);
  EXPECT_EQ(reported->bodies()->size(), 1U) << "slots, as before";
  // A body in a slot has its pose in the states; a change of it is not reported again.
  near.pose.position_m.x = 0.5;
  away.pose.position_m.z = 4.0;
  showRegistered({away, near});
  const auto moved = next(*first, fb::Payload::GameBodies);
  ASSERT_TRUE(moved);
  reported = message(*moved).payload_as_GameBodies();
  ASSERT_EQ(reported->registered()->size(), 1U);
  EXPECT_EQ(reported->registered()->Get(0)->number(), 1000U);
  EXPECT_EQ(reported->registered()->Get(0)->pose().position_m().z(), 4.0F);
  const auto later = client("?role=watcher");
  const auto joined = next(*later, fb::Payload::GameBodies);
  ASSERT_TRUE(joined);
  EXPECT_EQ(message(*joined).payload_as_GameBodies()->registered()->size(), 2U);
  showRegistered({near});
  const auto gone = next(*first, fb::Payload::GameBodies);
  ASSERT_TRUE(gone);
  reported = message(*gone).payload_as_GameBodies();
  ASSERT_EQ(reported->registered()->size(), 1U);
  EXPECT_EQ(reported->registered()->Get(0)->number(), 1000U);
  EXPECT_EQ(reported->registered()->Get(0)->whereabouts(), fb::Whereabouts::Gone);
}

TEST_F(BodiesTest, BodyAndItsEventInOneTick_AreReportedBodyFirst) {
  std::atomic<bool> happens{false};
  program.in_tick = [&] {
    if (!happens.exchange(false)) return;
    show(SlotState::kSolid);
    TickRecord record;
    record.tick = 1;
    record.exercise.event_count = 1;
    server->publish(record);
  };
  open();
  const auto socket = client("?role=watcher");
  ASSERT_TRUE(next(*socket, fb::Payload::Controls));
  happens = true;
  std::vector<fb::Payload> reported;
  while (reported.size() < 2) {
    const auto frame = socket->receive();
    ASSERT_TRUE(frame);
    const fb::Payload payload = message(*frame).payload_type();
    if (payload == fb::Payload::GameBodies || payload == fb::Payload::Events) {
      reported.push_back(payload);
    }
  }
  EXPECT_EQ(reported, (std::vector{fb::Payload::GameBodies, fb::Payload::Events}));
}

}  // namespace
}  // namespace wholehand::test
