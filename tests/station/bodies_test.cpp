// Orders of a game to its bodies, in a station that renders. In real time.
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
  /// With four slots and a device that moves a person.
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
    if (extra_ns) config.rehearsal.most_of_period = 1e4;  // less than extra_ns on any machine
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
  static Order say(std::vector<Command> commands, std::uint32_t claim = 0) {
    BodyOrders all;
    all.commands = std::move(commands);
    return bodies<orders::Spawn>(std::move(all), claim);  // the station reads the commands
  }
  /// State of a slot's body as reported to clients; parked where there is none.
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
  const OrderReply spawned = ask(say({spawnCommand(ballAside(4))}));
  ASSERT_TRUE(spawned.accepted) << spawned.reason;
  ASSERT_TRUE(becomes([&] { return stateOf(4) == SlotState::kSolid; }));
  TickRecord record;
  ASSERT_TRUE(station_->latest(record));
  EXPECT_EQ(record.bodies[4].position_m.x, 0.5);  // a scene without bodies of its own
  ASSERT_TRUE(ask(say({removeCommand(4, 1)})).accepted);
  EXPECT_TRUE(becomes([&] { return stateOf(4) == SlotState::kParked; }));
}

TEST_F(GameInAStation, BodiesBeyondTheSlots_AreShownAndThoseNearTheHandAreSimulated) {
  runGame(true);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  SpawnOrder near = ballAside(kFirstNumber), far = ballAside(kFirstNumber + 1);
  near.pose.position_m = {0.1, 0.25, 0.1};
  far.pose.position_m = {3.0, 0.0, 0.0};
  ASSERT_TRUE(ask(say({spawnCommand(near), spawnCommand(far)})).accepted);
  const auto shown = [&](int number) {
    const auto reported = station_->status().registered;
    for (const ShownBody& body : reported ? *reported : RegisteredBodies{}) {
      if (body.body.number == number && body.shapes) return body.body;
    }
    return RegisteredBody{};
  };
  ASSERT_TRUE(becomes([&] { return shown(kFirstNumber).whereabouts == Whereabouts::kInSlot; }));
  EXPECT_EQ(shown(kFirstNumber + 1).whereabouts, Whereabouts::kOutOfReach);
  EXPECT_EQ(shown(kFirstNumber + 1).pose.position_m.x, 3.0);
  const int slot = shown(kFirstNumber).slot;
  EXPECT_TRUE(becomes([&] { return stateOf(slot) == SlotState::kSolid; }));
  // A body elsewhere is out of its slot; one without is put there at once.
  BodyPose there;
  there.position_m = {0.0, -3.0, 0.0};
  ASSERT_TRUE(ask(say({teleportCommand(kFirstNumber, 1, there),
                       teleportCommand(kFirstNumber + 1, 1, there)}))
                  .accepted);
  EXPECT_TRUE(becomes([&] { return shown(kFirstNumber + 1).pose.position_m.y == -3.0; }));
  EXPECT_TRUE(becomes([&] { return shown(kFirstNumber).whereabouts == Whereabouts::kOutOfReach; }));
  EXPECT_EQ(stateOf(slot), SlotState::kParked);
  EXPECT_TRUE(becomes([&] { return shown(kFirstNumber).pose.position_m.y == -3.0; }));
  EXPECT_EQ(ask(prepare(0, {ballShape(0.02)})).items.at(0).refusal, BodyRefusal::kShapesBusy);
  ASSERT_TRUE(
      ask(say({removeCommand(kFirstNumber, 1), removeCommand(kFirstNumber + 1, 1)})).accepted);
  EXPECT_TRUE(station_->status().registered->empty());
}

TEST_F(GameInAStation, BadOrdersToBodiesBeyondTheSlots_AreNamed) {
  runGame(false);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  const auto refusalOf = [&](const Command& command, const char* says) {
    const OrderReply reply = ask(say({command}));
    if (reply.items.empty()) return BodyRefusal::kNone;
    EXPECT_NE(reply.reason.find(says), std::string::npos) << reply.reason;
    EXPECT_EQ(reply.items[0].slot, command.index);
    return reply.items[0].refusal;
  };
  std::vector<Command> all;
  for (int i = 0; i < kMostRegistered; ++i)
    all.push_back(spawnCommand(ballAside(kFirstNumber + i)));
  ASSERT_TRUE(ask(say(all)).accepted);
  EXPECT_EQ(refusalOf(spawnCommand(ballAside(kFirstNumber + 1000)), "1000 are registered"),
            BodyRefusal::kBudget);
  EXPECT_EQ(refusalOf(spawnCommand(ballAside(kFirstNumber)), "registered already"),
            BodyRefusal::kSlotTaken);
  EXPECT_EQ(refusalOf(spawnCommand(ballAside(kLastNumber + 1)), "[1000, 32767]"),
            BodyRefusal::kNoSuchSlot);
  EXPECT_EQ(refusalOf(removeCommand(9999, 1), "is registered"), BodyRefusal::kWrongGeneration);
  EXPECT_EQ(refusalOf(removeCommand(kFirstNumber, 2), "generation 2"),
            BodyRefusal::kWrongGeneration);
  ASSERT_TRUE(ask(say({removeCommand(kFirstNumber, 1)})).accepted);
  SpawnOrder without = ballAside(kFirstNumber);
  without.shape_set = 1;
  EXPECT_EQ(refusalOf(spawnCommand(without), "prepare it first"), BodyRefusal::kNoSuchShapes);
  SpawnOrder lost = ballAside(kFirstNumber);
  lost.pose.position_m.x = std::nan("");
  EXPECT_EQ(refusalOf(spawnCommand(lost), "must be finite"), BodyRefusal::kBadPose);
  EXPECT_EQ(station_->status().registered->size(), 999U);
  // They are there when it is armed, and end with their session.
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().registered->size(), 999U);
  EXPECT_EQ(refusalOf(bodyTargetCommand(kFirstNumber + 1, 1, {}), "owner Game"),
            BodyRefusal::kNotTheGames);
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  ASSERT_TRUE(becomes(RunState::kStopped));
  EXPECT_TRUE(station_->status().registered->empty());
}

TEST_F(GameInAStation, SlotOfARegisteredBody_IsNotSpawnedInto) {
  runGame(true);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  SpawnOrder near = ballAside(kFirstNumber);
  near.pose.position_m = {0.1, 0.25, 0.1};
  ASSERT_TRUE(ask(say({spawnCommand(near)})).accepted);
  ASSERT_TRUE(becomes([&] { return stateOf(0) == SlotState::kSolid; }));
  const OrderReply taken = ask(say({spawnCommand(ballAside(0))}));
  ASSERT_EQ(taken.refusal, Refusal::kBodiesRefused);
  EXPECT_EQ(taken.items.at(0).refusal, BodyRefusal::kSlotTaken);
  EXPECT_NE(taken.reason.find("holds a registered body"), std::string::npos) << taken.reason;
  EXPECT_TRUE(ask(say({spawnCommand(ballAside(1))})).accepted);
}

TEST_F(GameInAStation, DeviceThatMovesAPerson_IsArmedAfterARehearsalWithTheSlotsFull) {
  runForAPerson(1, nullptr);
  const OrderReply armed = ask(orders::Arm{});
  if (!armed.accepted) {  // a machine may be too slow for it, and for nothing else
    EXPECT_EQ(armed.refusal, Refusal::kRehearsalFailed) << armed.reason;
    EXPECT_NE(armed.reason.find("µs of CPU time (p99.9)"), std::string::npos) << armed.reason;
    return;
  }
  EXPECT_TRUE(says("1 awake and 3 fixed bodies of a game")) << log();
}

TEST_F(GameInAStation, DeviceThatMovesAPerson_IsRefusedWithWhatPassesWhereTheTickIsTooSlow) {
  runForAPerson(3, [](const TickRecord& record) -> std::int64_t {
    return record.exercise.values[2] > 1 ? 1'000'000'000'000 : 0;
  });
  const OrderReply armed = ask(orders::Arm{});
  ASSERT_FALSE(armed.accepted);
  EXPECT_EQ(armed.refusal, Refusal::kRehearsalFailed);
  EXPECT_NE(armed.reason.find("budget.awake = 3"), std::string::npos) << armed.reason;
  EXPECT_NE(armed.reason.find("state awake = 1,"), std::string::npos) << armed.reason;
  EXPECT_TRUE(says("rehearsal: measuring 3 awake bodies")) << log();
}

TEST_F(GameInAStation, SpawnedWhileDisarmed_IsInTheNextSession) {
  runGame(false);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  ASSERT_TRUE(ask(say({spawnCommand(ballAside(4, 7)), spawnCommand(ballAside(5))})).accepted);
  // As in a session: a slot once, and only shapes that were prepared and are free.
  EXPECT_EQ(ask(say({spawnCommand(ballAside(4, 8))})).items.at(0).refusal, BodyRefusal::kSlotTaken);
  EXPECT_EQ(ask(prepare(0, {ballShape(0.02)})).items.at(0).refusal, BodyRefusal::kShapesBusy);
  SpawnOrder without = ballAside(6);
  without.shape_set = 1;
  EXPECT_EQ(ask(say({spawnCommand(without)})).items.at(0).refusal, BodyRefusal::kNoSuchShapes);
  // A spawn can be taken back, by its generation.
  EXPECT_EQ(ask(say({removeCommand(5, 2)})).items.at(0).refusal, BodyRefusal::kWrongGeneration);
  ASSERT_TRUE(ask(say({removeCommand(5, 1)})).accepted);
  EXPECT_EQ(station_->status().bodies, nullptr);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(becomes([&] { return stateOf(4) == SlotState::kSolid; }));
  const auto reported = station_->status().bodies;
  ASSERT_EQ(reported->size(), 1U);
  EXPECT_EQ(reported->front().generation, 7);
}

TEST_F(GameInAStation, WhatIsKept_IsHandedOverOnce) {
  runGame(false);
  for (const Order& order : {prepare(0, {ballShape(0.03)}), say({spawnCommand(ballAside(0))})}) {
    const OrderReply kept = ask(order);
    ASSERT_TRUE(kept.accepted);
    EXPECT_EQ(kept.reason, "nothing is armed: kept for the next arming");
  }
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(becomes([&] { return stateOf(0) == SlotState::kSolid; }));
  EXPECT_EQ(ask(prepare(1, {ballShape(0.03)})).reason, "");  // handed over at once
  ASSERT_TRUE(ask(orders::Stop{}).accepted);
  EXPECT_EQ(ask(prepare(0, {ballShape(0.03)})).refusal, Refusal::kStillStopping);
  ASSERT_TRUE(becomes(RunState::kStopped));
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().bodies, nullptr);
  // Shapes are those of a session.
  const OrderReply spawn = ask(say({spawnCommand(ballAside(0))}));
  ASSERT_EQ(spawn.refusal, Refusal::kBodiesRefused);
  EXPECT_EQ(spawn.items.at(0).refusal, BodyRefusal::kNoSuchShapes);
}

TEST_F(GameInAStation, OrdersToBodiesThatAreNotThere_AreRefusedWhileDisarmed) {
  runGame(false);
  for (const Command& command : {bodyTargetCommand(0, 1, {}), teleportCommand(0, 1, {}),
                                 setOwnerCommand(0, 1, BodyOwner::kLoop)}) {
    const OrderReply reply = ask(say({command}));
    EXPECT_EQ(reply.refusal, Refusal::kNothingArmed);
    EXPECT_NE(reply.reason.find("kept for the next arming"), std::string::npos) << reply.reason;
  }
}

TEST_F(GameInAStation, MoreThanALoopTakesAtOnce_IsNotKept) {
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
  EXPECT_EQ(kept, 144);  // two commands each, 288 in all
  EXPECT_EQ(ask(say({removeCommand(0, 1)})).items.at(0).refusal, BodyRefusal::kWrongGeneration)
      << "a spawn could be taken back";
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  EXPECT_TRUE(rendersOn());
}

TEST_F(GameInAStation, WhatAnEarlierHolderKept_IsForgotten) {
  runGame(false);
  BodyOrders shapes;
  shapes.shape_set = 0;
  shapes.pieces = {ballShape(0.03)};
  ASSERT_TRUE(ask(bodies<orders::PrepareShapes>(shapes, 1)).accepted);
  ASSERT_TRUE(ask(say({spawnCommand(ballAside(0))}, 1)).accepted);
  const OrderReply spawn = ask(say({spawnCommand(ballAside(0))}, 2));
  ASSERT_EQ(spawn.refusal, Refusal::kBodiesRefused);
  EXPECT_EQ(spawn.items.at(0).refusal, BodyRefusal::kNoSuchShapes);
  ASSERT_TRUE(ask(orders::Arm{}).accepted);
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(station_->status().bodies, nullptr);
}

TEST_F(GameInAStation, WhatIsKept_IsForgottenWhenAnExerciseIsLoaded) {
  runGame(false);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  ASSERT_TRUE(ask(say({spawnCommand(ballAside(0))})).accepted);
  ASSERT_TRUE(ask(orders::LoadExercise{}).accepted);
  const OrderReply spawn = ask(say({spawnCommand(ballAside(0))}));
  ASSERT_EQ(spawn.refusal, Refusal::kBodiesRefused);
  EXPECT_EQ(spawn.items.at(0).refusal, BodyRefusal::kNoSuchShapes);
}

TEST_F(GameInAStation, SceneWithoutABudget_TakesNoBodies) {
  run(true);
  const OrderReply reply = ask(say({removeCommand(0, 1)}));
  EXPECT_EQ(reply.refusal, Refusal::kNoBodies);
  EXPECT_NE(reply.reason.find("game-scene"), std::string::npos);
}

TEST_F(GameInAStation, OrderOfAnEarlierHolder_IsRefused) {
  runGame(true);
  ASSERT_TRUE(ask(say({removeCommand(0, 1)}, 2)).accepted);
  EXPECT_EQ(ask(say({removeCommand(0, 1)}, 1)).refusal, Refusal::kNotHolder);
}

TEST_F(GameInAStation, MoreThanTheLoopTakes_IsAnsweredBusyAndTakenLater) {
  runGame(true);
  std::vector<Command> all;
  for (int slot = 0; slot < kMaxSlots; ++slot) all.push_back(removeCommand(slot, 1));
  bool busy = false;
  for (int i = 0; i < 1000 && !busy; ++i) {
    const OrderReply reply = ask(say(all));
    busy = reply.refusal == Refusal::kBusy;
    EXPECT_TRUE(busy || reply.accepted) << reply.reason;
  }
  EXPECT_TRUE(busy);
  EXPECT_TRUE(becomes([&] { return ask(say(all)).accepted; }));
  EXPECT_TRUE(rendersOn());
}

TEST_F(GameInAStation, WhileTheGameIsSilent_NothingIsSpawned) {
  runGame(true);
  ASSERT_TRUE(ask(prepare(0, {ballShape(0.03)})).accepted);
  ASSERT_TRUE(ask(orders::HolderAlive{false}).accepted);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(say({spawnCommand(ballAside(0))})).accepted)
      << "the loop refuses it, by an event";
  ASSERT_TRUE(rendersOn());
  EXPECT_EQ(stateOf(0), SlotState::kParked);
  ASSERT_TRUE(ask(orders::HolderAlive{true}).accepted);
  ASSERT_TRUE(rendersOn());
  ASSERT_TRUE(ask(say({spawnCommand(ballAside(0, 2))})).accepted);
  EXPECT_TRUE(becomes([&] { return stateOf(0) == SlotState::kSolid; }));
}

}  // namespace
}  // namespace wholehand::test
