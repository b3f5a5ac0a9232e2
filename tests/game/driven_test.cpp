// A body that a game moves: a bounded force, a bounded speed, a bounded energy.
#include "game/game_tools.hpp"
#include "support/seed.hpp"

namespace wholehand::test {
namespace {

constexpr double kDrivenForce_n = 5.0;

/// What a driven body did to the hand.
struct Push {
  double largest_n = 0.0;        ///< later than 20 ms after a first touch
  double longest_above_s = 0.0;  ///< above 1.1 F_max in one go
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
  const double slowest_m_s = std::min(speed_m_s, 0.05 / order.mass_kg);  // a heavy body is slow
  const int ticks = static_cast<int>(1e3 * way_m / slowest_m_s) + 500;
  for (int k = 0; k < ticks; ++k) {
    if (k % 16 == 0) {  // 60 Hz
      const double share = std::min(1.0, 1e-3 * k * speed_m_s / way_m);
      const Eigen::Quaterniond now = Eigen::Quaterniond::Identity().slerp(share, turn);
      game.order(bodyTargetCommand(0, 1, poseAt(start + share * (end - start), now)));
    }
    game.tick();
    EXPECT_FALSE(any(game.record.faults & kStopping));
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

TEST(DrivenBodies, AgainstTheHand_PushWithABoundedForceAndEnergy) {
  auto random = seededRandom(4302);
  Push worst;
  double most_share = 0.0;
  int touched = 0;
  const int count = cases(34);  // 1,020 of them where every large count is asked for
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
  if (kCountsTell) {
    EXPECT_GT(touched, count / 2);
  }
}

}  // namespace
}  // namespace wholehand::test
