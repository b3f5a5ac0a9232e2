// The event "touched": one for each touch of the hand by a body, with the impulse.
#include "game_bodies/game_tools.hpp"
#include "support/constants.hpp"

namespace wholehand::test {
namespace {

constexpr int kStrike = 10;  // ticks over which the impulse is summed

/// Touches reported for a slot, with tick and impulse.
struct ReportedTouch {
  std::uint64_t tick = 0;
  double impulse_ns = 0.0;
};

/// Runs and collects the touches reported for a slot.
std::vector<ReportedTouch> touchesOf(Game& game, int slot, int ticks,
                                     const std::function<void(int)>& each) {
  const auto& names = game.rig->models.exercise->description().event_names;
  std::vector<ReportedTouch> reported;
  for (int k = 0; k < ticks; ++k) {
    each(k);
    game.tick();
    for (int i = 0; i < game.record.exercise.event_count; ++i) {
      const ExerciseEvent& e = game.record.exercise.events[i];
      if (e.index == slot && names[e.type] == "touched") {
        reported.push_back({game.record.tick, e.value});
      }
    }
  }
  return reported;
}

/// Above the palm, out of reach of the hand.
Eigen::Vector3d above(Game& game) {
  const double highest_m = reach(game.rig->models.hand, game.record.q_s, Eigen::Vector3d::UnitZ());
  Eigen::Vector3d at = game.palm();
  at.z() = highest_m + 0.06;
  return at;
}

TEST(Touched, BallFallingOnTheHand_ReportsTheMomentumThatItLost) {
  Game game(std::vector<Shape>{ballShape(0.03)}, 100);
  SpawnOrder order = spawnOf(0, 0, BodyOwner::kLoop, poseAt(above(game)));
  order.mass_kg = 0.2;
  order.friction = 0.0;
  game.order(spawnCommand(order));
  std::vector<Eigen::Vector3d> velocity;  // before the step of each tick
  std::vector<bool> touching;             // in the step of each tick
  const auto reported = touchesOf(game, 0, 600, [&](int k) {
    if (k == 0) return;
    velocity.push_back(game.body(0).velocity_m_s.eigen());
    touching.push_back(game.forceOf(0).norm() > 0.0);
  });
  ASSERT_FALSE(reported.empty());
  const auto first = static_cast<std::size_t>(std::find(touching.begin(), touching.end(), true) -
                                              touching.begin());
  ASSERT_LT(first + kStrike, velocity.size());
  // Newton: the impulse on the hand is the momentum that the ball lost, plus its weight.
  const Eigen::Vector3d weight_ns(0.0, 0.0, -0.2 * kGravity_m_s2 * kStrike * 1e-3);
  const Eigen::Vector3d lost_ns = 0.2 * (velocity[first] - velocity[first + kStrike]) + weight_ns;
  EXPECT_NEAR(reported[0].impulse_ns, lost_ns.norm(), tolerance(1e-9));
  EXPECT_GT(reported[0].impulse_ns, 0.02);
  figure("impulse of a ball of 0.2 kg that falls on the hand", reported[0].impulse_ns, "N·s");
}

TEST(Touched, Touch_IsReportedOnceAndAgainAfterATenthOfASecondWithoutContact) {
  Game game(std::vector<Shape>{ballShape(0.03)}, 100);
  const Eigen::Vector3d high = above(game), palm = game.palm();
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kGame, poseAt(high))));
  const auto targetUntil = [&](const Eigen::Vector3d& at) {
    return [&game, at](int k) {
      if (k % 16 == 0) game.order(bodyTargetCommand(0, 1, poseAt(at)));
    };
  };
  EXPECT_EQ(touchesOf(game, 0, 1500, targetUntil(palm)).size(), 1U) << "pressed for a second";
  EXPECT_EQ(touchesOf(game, 0, 1000, targetUntil(high)).size(), 0U) << "goes away";
  EXPECT_EQ(touchesOf(game, 0, 1500, targetUntil(palm)).size(), 1U) << "comes again";
}

TEST(Touched, BouncesWithinATenthOfASecond_AreOneTouch) {
  Game game(std::vector<Shape>{ballShape(0.03)}, 100);
  const Eigen::Vector3d high = above(game), palm = game.palm();
  game.order(spawnCommand(spawnOf(0, 0, BodyOwner::kGame, poseAt(high))));
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  Eigen::Vector3d rests_at = palm;
  int touches = 0, gaps = 0;
  std::uint64_t last = 0;
  const auto reported = touchesOf(game, 0, 4000, [&](int k) {
    if (game.forceOf(0).norm() > 0.0) {
      if (last != 0 && game.record.tick > last + 1) {
        ++gaps;
        touches += game.record.tick - last - 1 >= 100 ? 1 : 0;
      }
      if (last == 0) ++touches;
      last = game.record.tick;
    }
    if (k % 16 != 0) return;
    if (k == 1504) rests_at = game.body(0).position_m.eigen();
    Eigen::Vector3d at = palm;
    if (k >= 1504) at = rests_at + 0.1 * std::sin(2.0 * M_PI * 7.0 * 1e-3 * k) * up;
    game.order(bodyTargetCommand(0, 1, poseAt(at)));
  });
  EXPECT_GT(gaps, 3) << "it bounces";
  EXPECT_EQ(static_cast<int>(reported.size()), touches);
}

TEST(Touched, BodyRemovedDuringAStrike_IsReportedBeforeItLeaves) {
  Game game(std::vector<Shape>{ballShape(0.03)}, 100);
  SpawnOrder order = spawnOf(0, 0, BodyOwner::kLoop, poseAt(above(game)));
  game.order(spawnCommand(order));
  const auto& names = game.rig->models.exercise->description().event_names;
  std::vector<std::string> reported;
  bool removed = false;
  for (int k = 0; k < 1000; ++k) {
    game.tick();
    if (!removed && game.forceOf(0).norm() > 0.0) {
      removed = true;
      game.order(removeCommand(0, 1));
    }
    for (int i = 0; i < game.record.exercise.event_count; ++i) {
      reported.push_back(names[game.record.exercise.events[i].type]);
    }
  }
  ASSERT_TRUE(removed);
  const auto touched = std::find(reported.begin(), reported.end(), "touched");
  const auto left = std::find(reported.begin(), reported.end(), "left");
  ASSERT_NE(left, reported.end());
  EXPECT_LT(touched - reported.begin(), left - reported.begin());
  EXPECT_EQ(std::count(reported.begin(), reported.end(), "touched"), 1);
}

// Bodies of a game that are teleported: they are ghosts until they overlap nothing.

/// A game with a solid ball of its own at a place.
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

TEST(Teleports, TargetTooFarForAFrame_IsATeleport) {
  DrivenBall ball(kAside_m);
  const Eigen::Vector3d far = kAside_m + Eigen::Vector3d(0.0, 0.26, 0.0);
  ball.target(far);
  EXPECT_TRUE(ball.game.until(0, "solid", 3)) << "and says so where it is free";
  EXPECT_EQ(ball.game.body(0).position_m.eigen(), far);
  EXPECT_EQ(ball.game.body(0).velocity_m_s.eigen().norm(), 0.0);
}

TEST(Teleports, TargetWithinAFrame_IsNoTeleport) {
  DrivenBall ball(kAside_m);
  ball.target(kAside_m + Eigen::Vector3d(0.0, 0.24, 0.0));
  for (int k = 0; k < 50; ++k) {
    ball.game.tick();
    EXPECT_EQ(ball.game.event(0), "");
    EXPECT_LE(ball.game.body(0).velocity_m_s.eigen().norm(), 0.5 + tolerance(1e-9));
  }
}

TEST(Teleports, TargetThatRunsAhead_IsNoTeleport) {
  // The body is limited to 0.5 m/s: it ends far behind its target, although no step of the target
  // was far.
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

TEST(Teleports, FarTargetWithinTheHand_MakesAGhostThatDoesNotPush) {
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

TEST(Teleports, FarTargetOfAPressedBody_ReleasesTheHandFirst) {
  Eigen::Vector3d at;
  Game game = pressedFromAbove(BodyOwner::kGame, at);
  const auto target = [&](const Eigen::Vector3d& to) {
    game.order(bodyTargetCommand(0, 1, poseAt(to)));
  };
  ASSERT_GT(game.forceOf(0).norm(), 1.0) << "it is pressed";
  // The game keeps sending targets, and the last one counts.
  Eigen::Vector3d far = at + Eigen::Vector3d(0.4, 0.0, 0.0);
  std::vector<std::string> events;
  double force_n = game.forceOf(0).norm(), largest_drop_n = 0.0;
  for (int k = 0; k < 1000; ++k) {
    if (k % 16 == 0) target(far += Eigen::Vector3d(0.0, 0.001, 0.0));
    game.tick();
    if (!game.event(0).empty()) events.push_back(game.event(0));
    largest_drop_n = std::max(largest_drop_n, k > 0 ? force_n - game.forceOf(0).norm() : 0.0);
    force_n = game.forceOf(0).norm();
    ASSERT_FALSE(any(game.record.faults & kStoppingFaults));
  }
  EXPECT_EQ(events, (std::vector<std::string>{"letting_go", "appeared", "solid"}));
  EXPECT_LT((game.body(0).position_m.eigen() - far).norm(), 0.02);
  EXPECT_LT(largest_drop_n, 0.5);
}

TEST(Teleports, TeleportByOrderIntoFreeSpace_IsReportedAsSolid) {
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
