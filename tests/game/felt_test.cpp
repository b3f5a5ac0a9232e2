// What a person feels when a body appears over the hand, or one that is pressed leaves.
#include "game/game_tools.hpp"
#include "support/seed.hpp"

namespace wholehand::test {
namespace {

constexpr int kAppears = 300;  // tick
constexpr int kTicks = 900;

/// To and fro through the middle, so that the hand leaves what appears over it.
Intention sweep() {
  AxisPosition left(6), right(6);
  left[1] = -0.06, right[1] = 0.06;
  right[3] = 0.6;
  return Intention::throughWaypoints(
      {{0.0, left}, {0.3, AxisPosition(6)}, {0.6, right}, {1.0, left}});
}

std::vector<AxisEffort> undisturbed(Models models) {
  Game game(std::move(models), sweep());
  std::vector<AxisEffort> efforts;
  for (int k = 0; k < kTicks; ++k) efforts.push_back(game.tick().sent);
  return efforts;
}

TEST(GameBodies, AppearingOverTheHand_AreNotFeltUntilSolid) {
  auto random = seededRandom(4301);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const std::vector<AxisEffort> before = undisturbed(gameModels());
  double largest = 0.0;
  int became_solid = 0, slews = 0, stayed = 0;
  const bool full = std::getenv("WHOLEHAND_FULL") != nullptr;
  const int count = full ? 10'000 : cases(40);
  for (int n = 0; n < count; ++n) {
    SCOPED_TRACE(n);
    Game game(gameModels(), sweep());
    game.prepare(0, {boxShape({0.04, 0.04, 0.04})});
    Shape beside = boxMesh({0.03, 0.05, 0.03});
    beside.in_body.translation_m.y() = 0.04;
    game.prepare(1, {ballShape(0.03), beside});
    game.run(kAppears);
    const HandModel& hand = game.rig->models.hand;
    const Capsule& over = hand.capsules[random() % hand.capsules.size()];
    const Eigen::Vector3d at = handAt(hand, game.record.q_s).linkPose(over.link) * over.a_m +
                               0.02 * Eigen::Vector3d(unit(random), unit(random), unit(random));
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(unit(random), unit(random), unit(random), 1.1).normalized();
    SpawnOrder order =
        spawnOf(0, static_cast<int>(random() % 2), static_cast<BodyOwner>(n % 3), poseAt(at, turn));
    order.mass_kg = 0.05 + 0.95 * std::abs(unit(random));
    game.order(spawnCommand(order));
    int solid_at = -1;
    const auto decided = [&](int k) { return full && solid_at >= 0 && k >= solid_at + 100; };
    for (int k = kAppears; k < kTicks && !decided(k); ++k) {
      game.tick();
      ASSERT_FALSE(any(game.record.faults & kStopping)) << "tick " << k;
      if (game.event(0) == "solid" && solid_at < 0) solid_at = k;
      if (solid_at < 0) {
        // An event tells of the step before; until its own step nothing was felt.
        for (int a = 0; a < 6; ++a) {
          largest = std::max(largest, std::abs(game.record.sent[a] - before[k][a]) /
                                          game.rig->models.device.axes[a].effort_limit);
        }
      } else if (k < solid_at + 100 && any(game.record.faults & Fault::kEffortSlew)) {
        ++slews;
      }
    }
    solid_at < 0 ? ++stayed : ++became_solid;
  }
  figure("effort by a ghost, of the limit", largest, "1");
  figure("ghosts that became solid", became_solid, "bodies");
  figure("ghosts that stayed", stayed, "bodies");
  EXPECT_LE(largest, tolerance(0.01));
  EXPECT_EQ(slews, 0);
  if (kCountsTell) {
    EXPECT_GT(became_solid, count / 4);
  }
}

/// Largest speed of the arm, after the person has pressed a body from above for a second and it was
/// taken away [m/s].
double armSpeedAfter(const std::function<Command()>& order, BodyOwner owner) {
  AxisPosition pressing(6);
  pressing[2] = -0.06;
  Game game(gameModels(), Intention::throughWaypoints({{0.0, AxisPosition(6)}, {0.5, pressing}}));
  game.prepare(0, {boxShape({0.25, 0.25, 0.04})});
  game.run(100);
  const double lowest_m = -reach(game.rig->models.hand, game.record.q_s, -Eigen::Vector3d::UnitZ());
  Eigen::Vector3d at = game.palm();
  at.z() = lowest_m - 0.025;
  game.order(spawnCommand(spawnOf(0, 0, owner, poseAt(at))));
  for (int k = 0; k < 1500; ++k) {
    if (owner == BodyOwner::kGame && k % 16 == 0) game.order(bodyTargetCommand(0, 1, poseAt(at)));
    game.tick();
  }
  EXPECT_GT(game.forceOf(0).norm(), 2.0) << "it is pressed";
  game.order(order());
  double fastest_m_s = 0.0;
  double force_n = game.forceOf(0).norm(), largest_drop_n = 0.0;
  for (int k = 0; k < 600; ++k) {
    game.tick();
    EXPECT_FALSE(any(game.record.faults & kStopping));
    if (k > 0) largest_drop_n = std::max(largest_drop_n, force_n - game.forceOf(0).norm());
    force_n = game.forceOf(0).norm();
    for (int a = 0; a < 3; ++a) {
      fastest_m_s = std::max(fastest_m_s, std::abs(game.record.qd_mf[a]));
    }
  }
  figure("largest drop of the force in a tick", largest_drop_n, "N");
  return fastest_m_s;
}

TEST(GameBodies, PressedAndRemoved_LetTheArmGoGently) {
  const double removed = armSpeedAfter([] { return removeCommand(0, 1); }, BodyOwner::kFixed);
  const double away = armSpeedAfter(
      [] {
        return teleportCommand(0, 1, poseAt({0.5, 0.5, 0.5}));
      },
      BodyOwner::kFixed);
  const double loosened =
      armSpeedAfter([] { return setOwnerCommand(0, 1, BodyOwner::kLoop); }, BodyOwner::kFixed);
  figure("arm after a removal", removed, "m/s");
  figure("arm after a teleport", away, "m/s");
  figure("arm after a change of owner", loosened, "m/s");
  EXPECT_LE(removed, tolerance(0.1));
  EXPECT_LE(away, tolerance(0.1));
  EXPECT_LE(loosened, tolerance(0.1));
}

}  // namespace
}  // namespace wholehand::test
