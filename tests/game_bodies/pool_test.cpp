// Slots: a spawned body behaves like a body of the scene, and a refused order changes nothing.
#include "game_bodies/game_tools.hpp"
#include "support/constants.hpp"

namespace wholehand::test {
namespace {

TEST(GamePool, BodySpawnedInFreeSpace_IsSolidAtOnceAndFalls) {
  Game game(std::vector<Shape>{boxShape({0.04, 0.05, 0.06})}, 2);
  game.order(spawnCommand(spawnOf(3, 0, BodyOwner::kLoop, poseAt(kAside_m))));
  game.tick();
  game.tick();
  EXPECT_EQ(game.event(3), "solid");
  game.run(100);
  // Symplectic Euler: after 101 steps v = 101 g T.
  EXPECT_NEAR(game.body(3).velocity_m_s.z, -kGravity_m_s2 * 0.101, tolerance(1e-9));
  EXPECT_EQ(game.body(3).position_m.x, kAside_m.x());
}

TEST(GamePool, BodyOfTheGame_IsWeightlessAndReachesItsTarget) {
  Game game(std::vector<Shape>{ballShape(0.03)});
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kGame, poseAt(kAside_m))));
  game.run(5);
  const Eigen::Vector3d goal = kAside_m + Eigen::Vector3d(0.1, 0.0, 0.05);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitX()));
  double fastest_m_s = 0.0;
  for (int k = 0; k < 1500; ++k) {
    if (k % 16 == 0) game.order(bodyTargetCommand(0, 1, poseAt(goal, turn)));
    game.tick();
    fastest_m_s = std::max(fastest_m_s, game.body(0).velocity_m_s.eigen().norm());
  }
  EXPECT_LE(fastest_m_s, 0.5 + tolerance(1e-9));
  EXPECT_GT(fastest_m_s, 0.45);
  EXPECT_LT((game.body(0).position_m.eigen() - goal).norm(), tolerance(2e-4));
  EXPECT_LT(game.body(0).orientation_xyzw.eigen().angularDistance(turn), tolerance(5e-3));
}

TEST(GamePool, EndOfTheTargets_StopsTheBody) {
  Game game(std::vector<Shape>{ballShape(0.03)});
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kGame, poseAt(kAside_m))));
  game.run(5);
  game.order(bodyTargetCommand(0, 1, poseAt(kAside_m + Eigen::Vector3d(0.2, 0.0, 0.0))));
  game.run(90);
  EXPECT_GT(game.body(0).velocity_m_s.x, 0.4);
  game.run(15);
  const double at_m = game.body(0).position_m.x;
  game.run(500);
  EXPECT_LT(game.body(0).velocity_m_s.eigen().norm(), 1e-3);
  EXPECT_LT(std::abs(game.body(0).position_m.x - at_m), 0.02);
}

TEST(GamePool, TwoBodiesSpawnedInOnePlace_BecomeSolidInSlotOrder) {
  Game game(std::vector<Shape>{boxShape({0.05, 0.05, 0.05})}, 1);
  for (const int slot : {5, 2}) {
    game.order(spawnCommand(spawnOf(slot, 0, BodyOwner::kFixed, poseAt(kAside_m))));
  }
  std::map<int, std::string> last;
  for (int k = 0; k < 20; ++k) {
    game.tick();
    for (const int slot : {5, 2}) {
      if (!game.event(slot).empty()) last[slot] = game.event(slot);
    }
  }
  EXPECT_EQ(last[2], "solid");
  EXPECT_EQ(last[5], "appeared");
  game.order(removeCommand(2, 1));
  EXPECT_TRUE(game.until(5, "solid", 5));
}

TEST(GamePool, MeshOfABox_RestsAtTheHeightOfTheBox) {
  std::array<double, 2> height_m{};
  for (const bool mesh : {false, true}) {
    Game game(gameModels(), atRest());
    const Eigen::Vector3d size(0.04, 0.05, 0.06);
    game.prepare(0, {boxShape({0.3, 0.3, 0.02})});
    game.prepare(1, {mesh ? boxMesh(size) : boxShape(size)});
    game.run(2);
    game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kFixed, poseAt(kAside_m))));
    const Eigen::Vector3d above = kAside_m + Eigen::Vector3d(0.0, 0.0, 0.045);
    game.order(spawnCommand(spawnOf(1, 1, BodyOwner::kLoop, poseAt(above))));
    game.run(1500);
    height_m[mesh ? 1 : 0] = game.body(1).position_m.z;
    EXPECT_EQ(game.body(1).velocity_m_s.eigen().norm(), 0.0);
  }
  EXPECT_NEAR(height_m[0], kAside_m.z() + 0.04, tolerance(5e-5));
  EXPECT_NEAR(height_m[1], height_m[0], tolerance(5e-5));
}

TEST(GamePool, BodyOnARemovedBody_Falls) {
  Game game(std::vector<Shape>{boxShape({0.1, 0.1, 0.02})}, 1);
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kFixed, poseAt(kAside_m))));
  const Eigen::Vector3d above = kAside_m + Eigen::Vector3d(0.0, 0.0, 0.0201);
  game.order(spawnCommand(spawnOf(1, 0, BodyOwner::kLoop, poseAt(above))));
  game.run(1500);
  EXPECT_EQ(game.body(1).velocity_m_s.eigen().norm(), 0.0);  // at rest
  game.order(removeCommand(0, 1));
  game.run(100);
  EXPECT_NEAR(game.body(1).velocity_m_s.z, -kGravity_m_s2 * 0.1, tolerance(0.02));
  // The slot can be used again with another generation.
  SpawnOrder again = spawnOf(0, 0, BodyOwner::kFixed, poseAt(kAside_m));
  again.generation = 2;
  game.order(spawnCommand(again));
  EXPECT_TRUE(game.until(0, "solid", 5));
}

TEST(GamePool, BodyThatFallsOutOfTheWorld_IsRemoved) {
  Game game(std::vector<Shape>{ballShape(0.03)});
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kLoop, poseAt(kAside_m))));
  EXPECT_TRUE(game.until(0, "left", 2000));
  bool named = false;
  for (int i = 0; i < game.record.exercise.event_count; ++i) {
    named = named || game.record.exercise.events[i].type == 4;
  }
  EXPECT_TRUE(named) << "quarantined";
  game.run(10);
  EXPECT_EQ(game.record.exercise.values[0], 0.0);
  EXPECT_FALSE(any(game.record.faults & kStoppingFaults));
}

TEST(GamePool, BodiesOfASilentGame_LeaveAfterFiveSeconds) {
  Game game(std::vector<Shape>{ballShape(0.03)});
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kGame, poseAt(kAside_m))));
  game.run(10);
  Command silent;
  silent.type = CommandType::kHolderAlive;
  game.order(silent);
  game.run(4990);
  EXPECT_EQ(game.record.exercise.values[0], 1.0);
  game.run(20);
  EXPECT_EQ(game.record.exercise.values[0], 0.0);
}

struct BadOrder {
  const char* what;
  Command command;
  BodyRefusal refusal;
};

TEST(GamePool, BadOrders_AreRefusedWithTheReasonAndChangeNothing) {
  Game game(std::vector<Shape>{boxShape({0.05, 0.05, 0.05})}, 1);
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kFixed, poseAt(kAside_m))));
  game.run(5);
  const auto changed = [](SpawnOrder order, auto change) {
    change(order);
    return spawnCommand(order);
  };
  const Eigen::Vector3d beside_m = kAside_m + Eigen::Vector3d(0.2, 0.0, 0.0);
  const SpawnOrder good = spawnOf(1, 0, BodyOwner::kLoop, poseAt(beside_m));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::Quaterniond off(1.01, 0.0, 0.0, 0.0);
  const PreparedShapes shapes =
      orThrow(prepareShapes({boxShape({0.05, 0.05, 0.05})}, game.rig->models.scene.game));
  Command too_large = shapeCommands(3, shapes)[1];
  const std::vector<BadOrder> bad = {
      {"slot", changed(good, [](auto& o) { o.slot = 64; }), BodyRefusal::kNoSuchSlot},
      {"negative slot", removeCommand(-1, 1), BodyRefusal::kNoSuchSlot},
      {"taken", changed(good, [](auto& o) { o.slot = 0; }), BodyRefusal::kSlotTaken},
      {"generation", removeCommand(0, 2), BodyRefusal::kWrongGeneration},
      {"parked", removeCommand(7, 1), BodyRefusal::kWrongGeneration},
      {"generation 0", changed(good, [](auto& o) { o.generation = 0; }),
       BodyRefusal::kWrongGeneration},
      {"set", changed(good, [](auto& o) { o.shape_set = 9; }), BodyRefusal::kNoSuchShapes},
      {"busy set", shapeCommands(0, shapes)[0], BodyRefusal::kShapesBusy},
      {"piece without set", too_large, BodyRefusal::kBadShapes},
      {"NaN", changed(good, [&](auto& o) { o.pose.position_m.x = nan; }), BodyRefusal::kBadPose},
      {"quaternion", teleportCommand(0, 1, poseAt(kAside_m, off)), BodyRefusal::kBadPose},
      {"world", teleportCommand(0, 1, poseAt({6.0, 0.0, 0.0})), BodyRefusal::kBadPose},
      {"velocity", changed(good, [](auto& o) { o.velocity_m_s.x = 3.0; }), BodyRefusal::kBadPose},
      {"owner", changed(good, [](auto& o) { o.owner = static_cast<BodyOwner>(7); }),
       BodyRefusal::kBadPose},
      {"mass", changed(good, [](auto& o) { o.mass_kg = 2.1; }), BodyRefusal::kBadMass},
      {"NaN mass", changed(good, [&](auto& o) { o.mass_kg = nan; }), BodyRefusal::kBadMass},
      {"friction", changed(good, [](auto& o) { o.friction = -0.1; }), BodyRefusal::kBadMass},
      {"target", bodyTargetCommand(0, 1, poseAt(kAside_m)), BodyRefusal::kNotTheGames},
      {"overlap",
       changed(good,
               [](auto& o) {
                 o.pose = poseAt(kAside_m);
                 o.refuse_overlap = true;
               }),
       BodyRefusal::kOverlap},
  };
  const BodyState before = game.body(0);
  for (const BadOrder& order : bad) {
    SCOPED_TRACE(order.what);
    game.order(order.command);
    BodyRefusal refused = BodyRefusal::kNone;
    for (int k = 0; k < 3; ++k) {
      game.tick();
      for (int i = 0; i < game.record.exercise.event_count; ++i) {
        const ExerciseEvent& e = game.record.exercise.events[i];
        if (e.type == 5) refused = static_cast<BodyRefusal>(static_cast<int>(e.value));
      }
    }
    EXPECT_STREQ(nameOf(refused), nameOf(order.refusal));
    EXPECT_EQ(game.record.exercise.values[0], 1.0);
    EXPECT_EQ(0, std::memcmp(&before, &game.body(0), sizeof before));
    EXPECT_FALSE(any(game.record.faults & kStoppingFaults));
  }
}

TEST(GamePool, SpawnBeyondTheBudget_IsRefused) {
  Game game(std::vector<Shape>{ballShape(0.01)}, 1);
  for (int slot = 0; slot < 30; ++slot) {
    const Eigen::Vector3d at(0.5, 0.04 * slot, 0.5);
    game.order(spawnCommand(spawnOf(slot, 0, BodyOwner::kLoop, poseAt(at))));
  }
  int refused = 0;
  for (int k = 0; k < 20; ++k) {
    game.tick();
    for (int i = 0; i < game.record.exercise.event_count; ++i) {
      const ExerciseEvent& e = game.record.exercise.events[i];
      if (e.type == 5 && static_cast<int>(e.value) == static_cast<int>(BodyRefusal::kBudget)) {
        ++refused;
      }
    }
  }
  EXPECT_EQ(refused, 6);
  EXPECT_EQ(game.record.exercise.values[0], 24.0);
}

TEST(GamePool, BodySpawnedWithVelocityAndSpin_HasBothWhenSolid) {
  Game game(std::vector<Shape>{ballShape(0.03)});
  SpawnOrder order = spawnOf(0, 0, BodyOwner::kLoop, poseAt({0.5, 0.3, 0.2}));
  order.velocity_m_s = {0.5, -1.0, 0.25};
  order.spin_rad_s = {-30.0, 1.0 / 3.0, 100.0};
  game.order(spawnCommand(order));
  ASSERT_TRUE(game.until(0, "solid", 20));
  game.tick();
  const BodyState& body = game.body(0);
  // A ball keeps its spin; it falls by g T per tick, of which a few may have passed.
  EXPECT_NEAR(body.angular_velocity_rad_s.x, -30.0, tolerance(1e-6));
  EXPECT_NEAR(body.angular_velocity_rad_s.y, 1.0 / 3.0, tolerance(1e-6));
  EXPECT_NEAR(body.angular_velocity_rad_s.z, 100.0, tolerance(1e-6));
  EXPECT_NEAR(body.velocity_m_s.x, 0.5, tolerance(1e-6));
  EXPECT_NEAR(body.velocity_m_s.z, 0.25, tolerance(0.03));
}

}  // namespace
}  // namespace wholehand::test
