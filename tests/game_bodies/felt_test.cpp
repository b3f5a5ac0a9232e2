// Effort on the person when a body appears over the hand, or when a pressed body leaves.
#include "game_bodies/game_tools.hpp"
#include "support/seed.hpp"

namespace wholehand::test {
namespace {

constexpr int kAppears = 300;  // tick in which the body appears
constexpr int kTicks = 900;

/// Moves to and fro through the middle, so that the hand leaves a body that appears over it.
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

TEST(GameBodies, BodiesAppearingOverTheHand_HaveNoEffectUntilSolid) {
  auto random = seededRandom(4301);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const std::vector<AxisEffort> before = undisturbed(gameModels());
  double largest = 0.0;
  int became_solid = 0, slews = 0, stayed = 0;
  const bool full = fullCounts();
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
      ASSERT_FALSE(any(game.record.faults & kStoppingFaults)) << "tick " << k;
      if (game.event(0) == "solid" && solid_at < 0) solid_at = k;
      if (solid_at < 0) {
        // An event reports the step before it; until then the body must have no effect.
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
  if (kStatisticsMeaningful) {
    EXPECT_GT(became_solid, count / 4);
  }
}

/// Largest speed of the arm [m/s], after the person pressed a body from above for a second and it
/// was taken away.
double armSpeedAfter(const std::function<Command()>& order, BodyOwner owner) {
  Eigen::Vector3d at;
  Game game = pressedFromAbove(owner, at);
  EXPECT_GT(game.forceOf(0).norm(), 2.0) << "it is pressed";
  game.order(order());
  double fastest_m_s = 0.0;
  double force_n = game.forceOf(0).norm(), largest_drop_n = 0.0;
  for (int k = 0; k < 600; ++k) {
    game.tick();
    EXPECT_FALSE(any(game.record.faults & kStoppingFaults));
    if (k > 0) largest_drop_n = std::max(largest_drop_n, force_n - game.forceOf(0).norm());
    force_n = game.forceOf(0).norm();
    for (int a = 0; a < 3; ++a) {
      fastest_m_s = std::max(fastest_m_s, std::abs(game.record.qd_mf[a]));
    }
  }
  figure("largest drop of the force in a tick", largest_drop_n, "N");
  return fastest_m_s;
}

TEST(GameBodies, PressedBodyThatIsRemoved_ReleasesTheArmGently) {
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

// Bodies driven by a game: bounded force, speed and energy.

constexpr double kDrivenForce_n = 5.0;

/// Effect of a driven body on the hand.
struct Push {
  double largest_n = 0.0;        ///< largest force later than 20 ms after a first touch [N]
  double longest_above_s = 0.0;  ///< longest uninterrupted time above 1.1 F_max [s]
  double energy_j = 0.0, way_m = 0.0;
  int touching = 0;
};

Push pushAcross(std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Game game(gameModels(), atRest());
  const bool box = random() % 2 == 0;
  game.prepare(0, {box ? boxShape({0.05, 0.05, 0.05}) : ballShape(0.03)});
  game.run(200);
  const Eigen::Vector3d from_side =
      Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
  const Eigen::Vector3d palm = game.palm();
  const Eigen::Vector3d start = palm + 0.25 * from_side;
  const Eigen::Vector3d end =
      palm - 0.15 * from_side + 0.03 * Eigen::Vector3d(unit(random), unit(random), unit(random));
  const double speed_m_s = 0.1 + 0.4 * std::abs(unit(random));
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(unit(random), unit(random), unit(random), 1.1).normalized();
  SpawnOrder order = spawnOf(0, 0, BodyOwner::kGame, poseAt(start));
  order.mass_kg = 0.05 + 0.95 * std::abs(unit(random));
  game.order(spawnCommand(order));
  const double way_m = (end - start).norm();
  Push out;
  out.way_m = way_m;
  double above_s = 0.0;
  const double slowest_m_s =
      std::min(speed_m_s, 0.05 / order.mass_kg);  // a heavy body moves slowly
  const int ticks = static_cast<int>(1e3 * way_m / slowest_m_s) + 500;
  for (int k = 0; k < ticks; ++k) {
    if (k % 16 == 0) {  // 60 Hz
      const double share = std::min(1.0, 1e-3 * k * speed_m_s / way_m);
      const Eigen::Quaterniond now = Eigen::Quaterniond::Identity().slerp(share, turn);
      game.order(bodyTargetCommand(0, 1, poseAt(start + share * (end - start), now)));
    }
    game.tick();
    EXPECT_FALSE(any(game.record.faults & kStoppingFaults));
    const Eigen::Vector3d force = game.forceOf(0);
    const BodyState& body = game.body(0);
    for (int i = 0; i < game.record.contact_count; ++i) {
      const Contact& c = game.record.contacts[i];
      const Eigen::Vector3d arm = c.point_m.eigen() - body.position_m.eigen();
      out.energy_j += 1e-3 * c.force_n.eigen().dot(body.velocity_m_s.eigen() +
                                                   body.angular_velocity_rad_s.eigen().cross(arm));
    }
    above_s = force.norm() > 1.1 * kDrivenForce_n ? above_s + 1e-3 : 0.0;
    if (force.norm() > 0.0) ++out.touching;
    out.longest_above_s = std::max(out.longest_above_s, above_s);
    if (above_s == 0.0) out.largest_n = std::max(out.largest_n, force.norm());
  }
  return out;
}

TEST(DrivenBodies, DrivenBodyAgainstTheHand_PushesWithBoundedForceAndEnergy) {
  auto random = seededRandom(4302);
  Push worst;
  double most_share = 0.0;
  int touched = 0;
  const int count = cases(34);  // 1,020 in a full run
  for (int n = 0; n < count; ++n) {
    SCOPED_TRACE(n);
    const Push push = pushAcross(random);
    EXPECT_LE(push.longest_above_s, tolerance(0.02));
    EXPECT_LE(push.energy_j, kDrivenForce_n * push.way_m);
    worst.longest_above_s = std::max(worst.longest_above_s, push.longest_above_s);
    most_share = std::max(most_share, push.energy_j / (kDrivenForce_n * push.way_m));
    if (push.touching > 0) ++touched;
  }
  figure("longest time above 1.1 F_max", 1e3 * worst.longest_above_s, "ms");
  figure("energy into the hand, of F_max times way", most_share, "1");
  figure("paths that met the hand", touched, "paths");
  if (kStatisticsMeaningful) {
    EXPECT_GT(touched, count / 2);
  }
}

// For any number of bodies, also if they push one another: docs/protocol.md, BodyTargets.
TEST(DrivenBodies, ManyDrivenBodiesAgainstTheHand_PushWithTheForceOfOne) {
  auto random = seededRandom(4303);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double largest_n = 0.0, longest_above_s = 0.0;
  for (int n = 0; n < cases(10); ++n) {
    SCOPED_TRACE(n);
    Game game(gameModels(), atRest());
    game.prepare(0, {ballShape(0.025)});
    game.run(200);
    const Eigen::Vector3d from =
        Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized();
    const Eigen::Vector3d aside = from.unitOrthogonal(), up = from.cross(aside);
    const Eigen::Vector3d palm = game.palm();
    const int count = std::min(game.rig->models.scene.game.slots, 24);
    const auto place = [&](int slot, double away_m) -> Eigen::Vector3d {
      return palm + (away_m + 0.055 * (slot / 4)) * from + 0.03 * (slot % 2 == 0 ? 1 : -1) * aside +
             0.03 * (slot % 4 < 2 ? 1 : -1) * up;
    };
    for (int slot = 0; slot < count; ++slot) {
      SpawnOrder order = spawnOf(slot, 0, BodyOwner::kGame, poseAt(place(slot, 0.2)));
      order.mass_kg = 0.3;
      game.order(spawnCommand(order));
    }
    double mean_n = 0.0, above_s = 0.0;
    for (int k = 0; k < 4000; ++k) {
      if (k % 32 == 0) {
        for (int slot = 0; slot < count; ++slot) {
          game.order(
              bodyTargetCommand(slot, 1, poseAt(place(slot, 0.2 - 1e-4 * std::min(k, 2500)))));
        }
      }
      game.tick();
      Eigen::Vector3d force = Eigen::Vector3d::Zero();
      for (int slot = 0; slot < count; ++slot) force += game.forceOf(slot);
      // A strike is over in 20 ms; sustained pressing is the mean over 0.2 s.
      above_s = force.norm() > 1.1 * kDrivenForce_n ? above_s + 1e-3 : 0.0;
      longest_above_s = std::max(longest_above_s, above_s);
      mean_n += 0.005 * (force.norm() - mean_n);
      largest_n = std::max(largest_n, mean_n);
    }
  }
  figure("24 driven bodies together, mean over 0.2 s", largest_n, "N");
  figure("their longest time above 1.1 F_max", 1e3 * longest_above_s, "ms");
  EXPECT_LE(largest_n, kDrivenForce_n);
  EXPECT_LE(longest_above_s, tolerance(0.02));
  EXPECT_GT(largest_n, 0.3 * kDrivenForce_n) << "they pressed";
}

}  // namespace
}  // namespace wholehand::test
