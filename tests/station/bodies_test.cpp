// Orders that a game gives to its bodies, checked in a station that renders. These tests run in
// real time.
#include "loop/core/body_order.hpp"
#include "station/station_bench.hpp"
#include "support/ball_shape.hpp"
#include "support/resting_device.hpp"

#include <fstream>
#include <functional>
#include <iterator>

namespace wholehand::test {
namespace {

SpawnOrder ballAside(int slot, int generation = 1) {
  SpawnOrder spawn;
  spawn.slot = slot;
  spawn.generation = generation;
  spawn.owner = BodyOwner::kFixed;
  spawn.pose.position_m = {0.5, 0.3, 0.2};
  return spawn;
}

class GameInAStation : public Bar {
 protected:
  void runGame(bool arm_at_once) {
    StationConfig config = barConfig();
    config.files.exercise = kRoot + "/config/exercises/game-scene.toml";
    config.rehearse = false;
    load(config);
    run(arm_at_once);
    if (arm_at_once) {
      ASSERT_TRUE(rendersOn());
    }
  }
  /// Loads a scene with four slots and a device that moves a person. `extra_ns` adds time [ns] to
  /// each measured tick of the rehearsal.
  void runForAPerson(int awake, const std::function<std::int64_t(const TickRecord&)>& extra_ns) {
    std::ifstream in(kRoot + "/config/exercises/game-scene.toml");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    const auto change = [&](const std::string& from, const std::string& to) {
      text.replace(text.find(from), from.size(), to);
    };
    change("slots = 64", "slots = 4");
    change("awake = 24", "awake = " + std::to_string(awake));
    change("../scenes", kRoot + "/config/scenes");
    fs::create_directories(folder_);
    std::ofstream(folder_ + "/game.toml") << text;
    StationConfig config = barConfig();
    config.files.exercise = folder_ + "/game.toml";
    config.rehearsal = {};
    if (extra_ns) config.rehearsal.allowed_period_share = 1e4;  // only extra_ns can exceed this
    config.rehearsal.extra_ns = extra_ns;
    config.make_device = [](const DeviceModel&) -> Expected<std::unique_ptr<HapticDevice>> {
      return std::unique_ptr<HapticDevice>(std::make_unique<RestingDevice>(AxisPosition(6)));
    };
    load(config);
    run(false);
  }
  template <class Kind>
  static Order bodies(BodyOrders all, std::uint32_t claim = 0) {
    Order order{Kind{{std::make_shared<const BodyOrders>(std::move(all))}}};
    order.claim = claim;
    return order;
  }
  static Order prepare(int set, std::vector<Shape> pieces) {
    BodyOrders all;
    all.shape_set = set;
    all.pieces = std::move(pieces);
    return bodies<orders::PrepareShapes>(std::move(all));
  }
  static Order orderOf(std::vector<Command> commands, std::uint32_t claim = 0) {
    BodyOrders all;
    all.commands = std::move(commands);
    return bodies<orders::Spawn>(std::move(all),
                                 claim);  // of any kind: the station reads the commands
  }
  /// State of a slot's body as reported to clients; kParked if none is reported.
  SlotState stateOf(int slot) {
    const auto reported = station_->status().bodies;
    if (!reported) return SlotState::kParked;
    for (const GameBody& body : *reported) {
      if (body.slot == slot) return body.state;
    }
    return SlotState::kParked;
  }
};

TEST_F(GameInAStation, BodyIsPreparedSpawnedShownAndRemoved) {
  runGame(true);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  const OrderReply spawned = ask(orderOf({spawnCommand(ballAside(4))}));
  ASSERT_TRUE(spawned.accepted) << spawned.reason;
  ASSERT_TRUE(becomes([&] { return stateOf(4) == SlotState::kSolid; }));
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  EXPECT_EQ(record.bodies[4].position_m.x, 0.5);  // the scene has no bodies of its own
  ASSERT_TRUE(ask(orderOf({removeCommand(4, 1)})).accepted);
  EXPECT_TRUE(becomes([&] { return stateOf(4) == SlotState::kParked; }));
}

TEST_F(GameInAStation, RegisteredBodies_AreAllShownAndOnlyThoseNearTheHandAreSimulated) {
  runGame(true);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  SpawnOrder near = ballAside(kFirstNumber), far = ballAside(kFirstNumber + 1);
  near.pose.position_m = {0.1, 0.25, 0.1};
  far.pose.position_m = {3.0, 0.0, 0.0};
  ASSERT_TRUE(ask(orderOf({spawnCommand(near), spawnCommand(far)})).accepted);
  const auto shown = [&](int number) {
    const auto reported = station_->status().registered;
    for (const RegisteredBody& body : reported ? *reported : RegisteredBodies{}) {
      if (body.number == number && body.shapes) return body;
    }
    return RegisteredBody{};
  };
  ASSERT_TRUE(becomes([&] { return shown(kFirstNumber).whereabouts == Whereabouts::kInSlot; }));
  EXPECT_EQ(shown(kFirstNumber + 1).whereabouts, Whereabouts::kOutOfReach);
  EXPECT_EQ(shown(kFirstNumber + 1).pose.position_m.x, 3.0);
  const int slot = shown(kFirstNumber).slot;
  EXPECT_TRUE(becomes([&] { return stateOf(slot) == SlotState::kSolid; }));
  // A body that is teleported out of reach leaves its slot; a body without a slot is moved at once.
  BodyPose there;
  there.position_m = {0.0, -3.0, 0.0};
  ASSERT_TRUE(ask(orderOf({teleportCommand(kFirstNumber, 1, there),
                           teleportCommand(kFirstNumber + 1, 1, there)}))
                  .accepted);
  EXPECT_TRUE(becomes([&] { return shown(kFirstNumber + 1).pose.position_m.y == -3.0; }));
  EXPECT_TRUE(becomes([&] { return shown(kFirstNumber).whereabouts == Whereabouts::kOutOfReach; }));
  EXPECT_EQ(stateOf(slot), SlotState::kParked);
  EXPECT_TRUE(becomes([&] { return shown(kFirstNumber).pose.position_m.y == -3.0; }));
  EXPECT_EQ(ask(prepare(0, {ballShape(0.02)})).items.at(0).refusal, BodyRefusal::kShapesBusy);
  ASSERT_TRUE(
      ask(orderOf({removeCommand(kFirstNumber, 1), removeCommand(kFirstNumber + 1, 1)})).accepted);
  EXPECT_TRUE(station_->status().registered->empty());
}

TEST_F(GameInAStation, BadOrdersToRegisteredBodies_AreRefusedWithTheReason) {
  runGame(false);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  const auto refusalOf = [&](const Command& command, const char* expected) {
    const OrderReply reply = ask(orderOf({command}));
    if (reply.items.empty()) return BodyRefusal::kNone;
    EXPECT_NE(reply.reason.find(expected), std::string::npos) << reply.reason;
    EXPECT_EQ(reply.items[0].slot, command.index);
    return reply.items[0].refusal;
  };
  std::vector<Command> all;
  for (int i = 0; i < kMostRegistered; ++i)
    all.push_back(spawnCommand(ballAside(kFirstNumber + i)));
  ASSERT_TRUE(ask(orderOf(all)).accepted);
  EXPECT_EQ(refusalOf(spawnCommand(ballAside(kFirstNumber + 1000)), "1000 are registered"),
            BodyRefusal::kBudget);
  EXPECT_EQ(refusalOf(spawnCommand(ballAside(kFirstNumber)), "registered already"),
            BodyRefusal::kSlotTaken);
  EXPECT_EQ(refusalOf(spawnCommand(ballAside(kLastNumber + 1)), "[1000, 32767]"),
            BodyRefusal::kNoSuchSlot);
  EXPECT_EQ(refusalOf(removeCommand(9999, 1), "is registered"), BodyRefusal::kWrongGeneration);
  EXPECT_EQ(refusalOf(removeCommand(kFirstNumber, 2), "generation 2"),
            BodyRefusal::kWrongGeneration);
  ASSERT_TRUE(ask(orderOf({removeCommand(kFirstNumber, 1)})).accepted);
  SpawnOrder without = ballAside(kFirstNumber);
  without.shape_set = 1;
  EXPECT_EQ(refusalOf(spawnCommand(without), "prepare it first"), BodyRefusal::kNoSuchShapes);
  SpawnOrder lost = ballAside(kFirstNumber);
  lost.pose.position_m.x = std::nan("");
  EXPECT_EQ(refusalOf(spawnCommand(lost), "must be finite"), BodyRefusal::kBadPose);
  EXPECT_EQ(station_->status().registered->size(), 999U);
  // The bodies exist when the session is armed and are removed when it ends.
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().registered->size(), 999U);
  EXPECT_EQ(refusalOf(bodyTargetCommand(kFirstNumber + 1, 1, {}), "owner Game"),
            BodyRefusal::kNotTheGames);
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  EXPECT_TRUE(station_->status().registered->empty());
}

TEST_F(GameInAStation, SpawnIntoTheSlotOfARegisteredBody_IsRefused) {
  runGame(true);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  SpawnOrder near = ballAside(kFirstNumber);
  near.pose.position_m = {0.1, 0.25, 0.1};
  ASSERT_TRUE(ask(orderOf({spawnCommand(near)})).accepted);
  ASSERT_TRUE(becomes([&] { return stateOf(0) == SlotState::kSolid; }));
  const OrderReply taken = ask(orderOf({spawnCommand(ballAside(0))}));
  ASSERT_EQ(taken.refusal, Refusal::kBodiesRefused);
  EXPECT_EQ(taken.items.at(0).refusal, BodyRefusal::kSlotTaken);
  EXPECT_NE(taken.reason.find("holds a registered body"), std::string::npos) << taken.reason;
  EXPECT_TRUE(ask(orderOf({spawnCommand(ballAside(1))})).accepted);
}

TEST_F(GameInAStation, DeviceThatMovesAPerson_IsArmedAfterARehearsalWithAllSlotsFull) {
  runForAPerson(1, nullptr);
  const OrderReply armed = ask(orders::Arm{});
  if (!armed.accepted) {  // a slow machine may fail the rehearsal; no other refusal is allowed
    EXPECT_EQ(armed.refusal, Refusal::kRehearsalFailed) << armed.reason;
    EXPECT_NE(armed.reason.find("µs of CPU time (p99.9)"), std::string::npos) << armed.reason;
    return;
  }
  EXPECT_TRUE(logContains("1 awake and 3 fixed bodies of a game")) << log();
}

TEST_F(GameInAStation, RehearsalWithTooSlowATick_IsRefusedAndNamesTheBudgetThatPasses) {
  runForAPerson(3, [](const TickRecord& record) -> std::int64_t {
    return record.exercise.values[2] > 1 ? 1'000'000'000'000 : 0;
  });
  const OrderReply armed = ask(orders::Arm{});
  ASSERT_FALSE(armed.accepted);
  EXPECT_EQ(armed.refusal, Refusal::kRehearsalFailed);
  EXPECT_NE(armed.reason.find("budget.awake = 3"), std::string::npos) << armed.reason;
  EXPECT_NE(armed.reason.find("state awake = 1,"), std::string::npos) << armed.reason;
  EXPECT_TRUE(logContains("rehearsal: measuring 3 awake bodies")) << log();
}

TEST_F(GameInAStation, SpawnedWhileDisarmed_IsInTheNextSession) {
  runGame(false);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  ASSERT_TRUE(ask(orderOf({spawnCommand(ballAside(4, 7)), spawnCommand(ballAside(5))})).accepted);
  // The rules of a session hold: a slot is used once, and the shapes must be prepared and free.
  EXPECT_EQ(ask(orderOf({spawnCommand(ballAside(4, 8))})).items.at(0).refusal,
            BodyRefusal::kSlotTaken);
  EXPECT_EQ(ask(prepare(0, {ballShape(0.02)})).items.at(0).refusal, BodyRefusal::kShapesBusy);
  SpawnOrder without = ballAside(6);
  without.shape_set = 1;
  EXPECT_EQ(ask(orderOf({spawnCommand(without)})).items.at(0).refusal, BodyRefusal::kNoSuchShapes);
  // A spawn can be removed again; the remove must name its generation.
  EXPECT_EQ(ask(orderOf({removeCommand(5, 2)})).items.at(0).refusal, BodyRefusal::kWrongGeneration);
  ASSERT_TRUE(ask(orderOf({removeCommand(5, 1)})).accepted);
  EXPECT_EQ(station_->status().bodies, nullptr);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(becomes([&] { return stateOf(4) == SlotState::kSolid; }));
  const auto reported = station_->status().bodies;
  ASSERT_EQ(reported->size(), 1U);
  EXPECT_EQ(reported->front().generation, 7);
}

TEST_F(GameInAStation, OrdersKeptForTheNextArming_AreHandedOverOnce) {
  runGame(false);
  for (const Order& order :
       {prepare(0, {ballShape(0.03)}), orderOf({spawnCommand(ballAside(0))})}) {
    const OrderReply kept = ask(order);
    ASSERT_TRUE(kept.accepted);
    EXPECT_EQ(kept.reason, "nothing is armed: kept for the next arming");
  }
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(becomes([&] { return stateOf(0) == SlotState::kSolid; }));
  EXPECT_EQ(ask(prepare(1, {ballShape(0.03)})).reason, "");  // the session takes it at once
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  EXPECT_EQ(ask(prepare(0, {ballShape(0.03)})).refusal, Refusal::kStillStopping);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().bodies, nullptr);
  // Prepared shapes end with their session.
  const OrderReply spawn = ask(orderOf({spawnCommand(ballAside(0))}));
  ASSERT_EQ(spawn.refusal, Refusal::kBodiesRefused);
  EXPECT_EQ(spawn.items.at(0).refusal, BodyRefusal::kNoSuchShapes);
}

TEST_F(GameInAStation, OrdersToAbsentBodiesWhileDisarmed_AreRefused) {
  runGame(false);
  for (const Command& command : {bodyTargetCommand(0, 1, {}), teleportCommand(0, 1, {}),
                                 setOwnerCommand(0, 1, BodyOwner::kLoop)}) {
    const OrderReply reply = ask(orderOf({command}));
    EXPECT_EQ(reply.refusal, Refusal::kNothingArmed);
    EXPECT_NE(reply.reason.find("kept for the next arming"), std::string::npos) << reply.reason;
  }
}

TEST_F(GameInAStation, OrdersBeyondTheLoopsQueueWhileDisarmed_AreRefusedAsBusy) {
  runGame(false);
  bool busy = false;
  int kept = 0;
  for (int i = 0; i < 300 && !busy; ++i) {
    const OrderReply reply = ask(prepare(i % 32, {ballShape(0.03)}));
    busy = reply.refusal == Refusal::kBusy;
    kept += reply.accepted ? 1 : 0;
    EXPECT_TRUE(busy || reply.accepted) << reply.reason;
  }
  EXPECT_TRUE(busy);
  EXPECT_EQ(kept, 144);  // two commands each, 288 in total
  EXPECT_EQ(ask(orderOf({removeCommand(0, 1)})).items.at(0).refusal, BodyRefusal::kWrongGeneration)
      << "a spawn could be taken back";
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  EXPECT_TRUE(rendersOn());
}

TEST_F(GameInAStation, KeptOrdersOfAnEarlierHolder_AreDropped) {
  runGame(false);
  BodyOrders shapes;
  shapes.shape_set = 0;
  shapes.pieces = {ballShape(0.03)};
  ASSERT_TRUE(ask(bodies<orders::PrepareShapes>(shapes, 1)).accepted);
  ASSERT_TRUE(ask(orderOf({spawnCommand(ballAside(0))}, 1)).accepted);
  const OrderReply spawn = ask(orderOf({spawnCommand(ballAside(0))}, 2));
  ASSERT_EQ(spawn.refusal, Refusal::kBodiesRefused);
  EXPECT_EQ(spawn.items.at(0).refusal, BodyRefusal::kNoSuchShapes);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().bodies, nullptr);
}

TEST_F(GameInAStation, KeptOrders_AreDroppedWhenAnExerciseIsLoaded) {
  runGame(false);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  ASSERT_TRUE(ask(orderOf({spawnCommand(ballAside(0))})).accepted);
  ASSERT_TRUE(ask(orders::LoadExercise{}).accepted);
  const OrderReply spawn = ask(orderOf({spawnCommand(ballAside(0))}));
  ASSERT_EQ(spawn.refusal, Refusal::kBodiesRefused);
  EXPECT_EQ(spawn.items.at(0).refusal, BodyRefusal::kNoSuchShapes);
}

TEST_F(GameInAStation, SceneWithoutABodyBudget_RefusesBodies) {
  run(true);
  const OrderReply reply = ask(orderOf({removeCommand(0, 1)}));
  EXPECT_EQ(reply.refusal, Refusal::kNoBodies);
  EXPECT_NE(reply.reason.find("game-scene"), std::string::npos);
}

TEST_F(GameInAStation, OrderOfAnEarlierHolder_IsRefused) {
  runGame(true);
  ASSERT_TRUE(ask(orderOf({removeCommand(0, 1)}, 2)).accepted);
  EXPECT_EQ(ask(orderOf({removeCommand(0, 1)}, 1)).refusal, Refusal::kNotHolder);
}

TEST_F(GameInAStation, OrdersBeyondTheLoopsQueue_AreAnsweredBusyAndAcceptedLater) {
  runGame(true);
  std::vector<Command> all;
  for (int slot = 0; slot < kMaxSlots; ++slot) all.push_back(removeCommand(slot, 1));
  bool busy = false;
  for (int i = 0; i < 1000 && !busy; ++i) {
    const OrderReply reply = ask(orderOf(all));
    busy = reply.refusal == Refusal::kBusy;
    EXPECT_TRUE(busy || reply.accepted) << reply.reason;
  }
  EXPECT_TRUE(busy);
  EXPECT_TRUE(becomes([&] { return ask(orderOf(all)).accepted; }));
  EXPECT_TRUE(rendersOn());
}

TEST_F(GameInAStation, SpawnWhileTheGameIsSilent_IsNotCarriedOut) {
  runGame(true);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  ASSERT_TRUE(ask(orders::HolderAlive{false}).accepted);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orderOf({spawnCommand(ballAside(0))})).accepted)
      << "the loop refuses it, by an event";
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(stateOf(0), SlotState::kParked);
  ASSERT_TRUE(ask(orders::HolderAlive{true}).accepted);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(orderOf({spawnCommand(ballAside(0, 2))})).accepted);
  EXPECT_TRUE(becomes([&] { return stateOf(0) == SlotState::kSolid; }));
}

}  // namespace
}  // namespace wholehand::test
