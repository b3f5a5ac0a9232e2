// Bodies of a game that are somewhere else at once: ghosts until they overlap nothing.
#include "game/game_tools.hpp"

namespace wholehand::test {
namespace {

const Eigen::Vector3d kAside_m(0.5, 0.3, 0.2);

/// A game with a ball of its own at a place, solid.
struct DrivenBall {
  DrivenBall(const Eigen::Vector3d& at, Intention intention = atRest())
      : game(gameModels(), std::move(intention)) {
    game.prepare(0, {ballShape(0.03)});
    game.run(100);
    game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kGame, poseAt(at))));
    EXPECT_TRUE(game.until(0, "solid", 5));
  }
  void target(const Eigen::Vector3d& at) { game.order(bodyTargetCommand(0, 1, poseAt(at))); }
  Game game;
};

TEST(Teleports, TargetTooFarForAFrame_IsOne) {
  DrivenBall ball(kAside_m);
  const Eigen::Vector3d far = kAside_m + Eigen::Vector3d(0.0, 0.26, 0.0);
  ball.target(far);
  EXPECT_TRUE(ball.game.until(0, "solid", 3)) << "and says so where it is free";
  EXPECT_EQ(ball.game.body(0).position_m.eigen(), far);
  EXPECT_EQ(ball.game.body(0).velocity_m_s.eigen().norm(), 0.0);
}

TEST(Teleports, TargetWithinAFrame_IsNone) {
  DrivenBall ball(kAside_m);
  ball.target(kAside_m + Eigen::Vector3d(0.0, 0.24, 0.0));
  for (int k = 0; k < 50; ++k) {
    ball.game.tick();
    EXPECT_EQ(ball.game.event(0), "");
    EXPECT_LE(ball.game.body(0).velocity_m_s.eigen().norm(), 0.5 + tolerance(1e-9));
  }
}

TEST(Teleports, TargetThatRunsAhead_IsNone) {
  // The body is held to 0.5 m/s: it ends far behind its target, and no step was far.
  DrivenBall ball(kAside_m);
  for (int k = 0; k < 60; ++k) {
    ball.target(kAside_m - Eigen::Vector3d(0.0, 0.02 * k, 0.0));
    for (int i = 0; i < 16; ++i) {
      ball.game.tick();
      EXPECT_EQ(ball.game.event(0), "");
    }
  }
  EXPECT_GT(ball.game.body(0).position_m.y, kAside_m.y() - 0.5);
}

TEST(Teleports, FarTargetWithinTheHand_MakesAGhostThatPushesNobody) {
  DrivenBall ball(kAside_m);
  ball.target(ball.game.palm());
  EXPECT_TRUE(ball.game.until(0, "appeared", 3));
  for (int k = 0; k < 500; ++k) {
    if (k % 16 == 0) ball.target(ball.game.palm());
    ball.game.tick();
    EXPECT_EQ(ball.game.forceOf(0).norm(), 0.0);
    EXPECT_EQ(ball.game.event(0), "");
  }
}

TEST(Teleports, FarTargetOfAPressedBody_LetsTheHandGoFirst) {
  AxisPosition pressing(6);
  pressing[2] = -0.06;
  Game game(gameModels(), Intention::throughWaypoints({{0.0, AxisPosition(6)}, {0.5, pressing}}));
  game.prepare(0, {boxShape({0.25, 0.25, 0.04})});
  game.run(100);
  Eigen::Vector3d at = game.palm();
  at.z() = -reach(game.rig->models.hand, game.record.q_s, -Eigen::Vector3d::UnitZ()) - 0.025;
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kGame, poseAt(at))));
  const auto target = [&](const Eigen::Vector3d& to) {
    game.order(bodyTargetCommand(0, 1, poseAt(to)));
  };
  for (int k = 0; k < 1500; ++k) {
    if (k % 16 == 0) target(at);
    game.tick();
  }
  ASSERT_GT(game.forceOf(0).norm(), 1.0) << "it is pressed";
  // The game does not stop to name targets, and the last one counts.
  Eigen::Vector3d far = at + Eigen::Vector3d(0.4, 0.0, 0.0);
  std::vector<std::string> events;
  double force_n = game.forceOf(0).norm(), largest_drop_n = 0.0;
  for (int k = 0; k < 1000; ++k) {
    if (k % 16 == 0) target(far += Eigen::Vector3d(0.0, 0.001, 0.0));
    game.tick();
    if (!game.event(0).empty()) events.push_back(game.event(0));
    largest_drop_n = std::max(largest_drop_n, k > 0 ? force_n - game.forceOf(0).norm() : 0.0);
    force_n = game.forceOf(0).norm();
    ASSERT_FALSE(any(game.record.faults & kStopping));
  }
  EXPECT_EQ(events, (std::vector<std::string>{"letting_go", "appeared", "solid"}));
  EXPECT_LT((game.body(0).position_m.eigen() - far).norm(), 0.02);
  EXPECT_LT(largest_drop_n, 0.5);
}

TEST(Teleports, ByOrderIntoFreeSpace_AreSolidAndSaySo) {
  DrivenBall ball(kAside_m);
  const Eigen::Vector3d beside = kAside_m + Eigen::Vector3d(0.0, 0.1, 0.0);
  ball.game.order(teleportCommand(0, 1, poseAt(beside)));
  EXPECT_TRUE(ball.game.until(0, "solid", 3));
  EXPECT_EQ(ball.game.body(0).position_m.eigen(), beside);
  ball.game.order(setOwnerCommand(0, 1, BodyOwner::kFixed));
  EXPECT_TRUE(ball.game.until(0, "solid", 3)) << "handed over where it overlaps nothing";
  ball.game.run(3);
  EXPECT_EQ(ball.game.event(0), "") << "once";
}

}  // namespace
}  // namespace wholehand::test
