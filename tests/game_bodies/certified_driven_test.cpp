// Random certified gains, random persons and random driven bodies pulled against the hand: no loop
// is unstable, and a body gives the hand no more energy than the travel of its target allows.
#include "certify/certificate.hpp"
#include "certify/certified_sets.hpp"
#include "experiments/felt_noise.hpp"
#include "experiments/sweep/contact_trial.hpp"
#include "game_bodies/game_tools.hpp"
#include "rig/models.hpp"
#include "support/shipped.hpp"

namespace wholehand::test {
namespace {

constexpr double kMostForce_n = 5.0, kMostDrive_m_s = 0.5, kMostMomentum_ns = 0.05;
constexpr double kTurnShare = 0.1;  // share of kMostForce_n for turning, at the outermost point
constexpr int kFrame = 16;          // ticks between two targets, for 60 Hz
constexpr int kWindow = 300;        // ticks over which the noise is measured
constexpr int kLeastHold = 1500, kMostHold = 30000;  // ticks; some persons oscillate for long

Eigen::Vector3d direction(Draw& draw) {
  const double z = 2.0 * draw.unit() - 1.0, turn = 2.0 * M_PI * draw.unit();
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

/// Randomises the gains, masses and delays of a shipped device; they are not certified yet.
void shuffle(Models& m, Draw& draw) {
  m.device.output_delay_ticks = draw.upTo(3);
  const bool slippery = draw.chance(0.5);  // dry friction would hide slow growth
  for (std::size_t a = 0; a < m.device.axes.size(); ++a) {
    m.device.axes[a].mass *= draw.between(0.3, 3.0);
    if (slippery) m.device.axes[a].coulomb = m.device.axes[a].encoder_step = 0.0;
    AxisRendering& gains = m.rendering.axes[a];
    gains.k_pm *= draw.between(0.2, 3.0);
    gains.armature.reset();  // the rule chooses it
    gains.k_dm *= draw.chance(0.2) ? 0.0 : draw.between(0.1, 3.0);
    gains.gamma = draw.chance(0.15) ? 0.0 : draw.unit();
    gains.velocity_filter_hz = draw.between(15.0, 100.0);
  }
}

/// A shipped device and hand with random gains, and with slightly more damping than the certificate
/// requires.
Models certifiedModels(Draw& draw) {
  const auto devices = shipped("devices"), hands = shipped("hands");
  for (;;) {
    Models m = gameModels(devices[draw.upTo(static_cast<int>(devices.size()) - 1)],
                          hands[draw.upTo(static_cast<int>(hands.size()) - 1)]);
    shuffle(m, draw);
    double spare = 1.0005 + 0.5 * draw.unit() * draw.unit();
    for (int attempt = 0; attempt < 3; ++attempt) {
      const Certificate found = certify(certificateInput(m, 1e-3));
      if (attempt > 0 && found.certified && checkGains(m, 1e-3)->refused.empty()) return m;
      if (attempt > 0) spare *= 1.0005 / std::min(1.0, found.coupled.margin);
      for (std::size_t a = 0; a < m.device.axes.size(); ++a) {
        DeviceAxis& axis = m.device.axes[a];
        axis.damping = std::max(found.axes[a].damping_required, 1e-5) * spare;
        axis.effort_slew_limit =
            std::max(axis.effort_slew_limit, 1.001 * found.axes[a].slew_required);
      }
    }
  }
}

enum class Holder { kNobody, kRelaxed, kStiff, kAnybody };

void attach(Holder holder, Models& m, Draw& draw) {
  for (std::size_t a = 0; a < m.patient.axes.size(); ++a) {
    const bool turns = m.device.axes[a].kind == AxisKind::kRotation;
    const double arm2 = turns ? 0.08 * 0.08 : 1.0;
    PatientAxis& person = m.patient.axes[a];
    person.tremor = 0.0;
    if (holder == Holder::kNobody) person.mass = person.damping = person.stiffness = 0.0;
    if (holder == Holder::kStiff) {
      person.mass = 0.2 * arm2, person.damping = 2.0 * arm2, person.stiffness = 5000.0 * arm2;
    }
    if (holder == Holder::kAnybody) {
      person.mass = draw.chance(0.2) ? 0.0 : draw.between(0.05, 5.0) * arm2;
      person.damping = draw.between(0.1, 50.0) * arm2;
      person.stiffness = draw.between(10.0, 5000.0) * arm2;
    }
  }
}

struct Body {
  Shape shape;
  SpawnOrder order;
  double radius_m = 0.0;  ///< distance of its outermost point
};

Body randomBody(const GameBudget& budget, Draw& draw) {
  Body body;
  const double kind = draw.unit();
  Eigen::Vector3d size;
  for (double& s : size) s = draw.between(0.01, 0.12);
  if (kind < 0.4) body.shape = ballShape(0.5 * size.x());
  if (kind >= 0.4) body.shape = kind < 0.7 ? boxShape(size) : boxMesh(size);
  body.radius_m = kind < 0.4 ? 0.5 * size.x() : 0.5 * size.norm();
  body.order = spawnOf(0, 0, BodyOwner::kGame, {});
  body.order.mass_kg =
      draw.chance(0.25) ? budget.least_kg : draw.between(budget.least_kg, budget.most_kg);
  body.order.friction = draw.chance(0.2) ? 0.0 : draw.between(0.05, 2.0);
  return body;
}

/// Corners of the target's path, and the orientation at each.
struct Path {
  std::vector<Eigen::Vector3d> at_m;
  std::vector<Eigen::Quaterniond> turn;
  std::vector<int> ticks;  ///< ticks to the next corner
};

/// A path from one side through the palm and around it; most paths end beyond or inside the palm.
Path randomPath(const Eigen::Vector3d& palm, double most_m_s, Draw& draw) {
  Path path;
  const Eigen::Vector3d side = direction(draw);
  path.at_m = {palm + 0.25 * side, palm - draw.between(0.02, 0.2) * side};
  for (int more = draw.upTo(2); more > 0; --more) {
    path.at_m.emplace_back(palm + draw.between(0.01, 0.15) * direction(draw));
  }
  for (std::size_t i = 0; i < path.at_m.size(); ++i) {
    path.turn.emplace_back(Eigen::AngleAxisd(i == 0 ? 0.0 : M_PI * draw.unit(), direction(draw)));
    if (i == 0) continue;
    const double way_m = (path.at_m[i] - path.at_m[i - 1]).norm();
    path.ticks.push_back(
        1 + static_cast<int>(1e3 * way_m / std::min(draw.between(0.1, kMostDrive_m_s), most_m_s)));
  }
  path.ticks.push_back(0);
  return path;
}

/// Balances the energy of a driven body against the travel of its target. While the target is at
/// rest, pull and damper are passive; a target that moves by d puts in |f| d at most.
class Ledger {
 public:
  Ledger(double mass_kg, double radius_m) : mass_kg_(mass_kg), radius_m_(radius_m) {}
  void targetMoved(double way_m, double turn_rad) {
    pull_allowed_j_ += (1.0 - kTurnShare) * kMostForce_n * way_m;
    turn_allowed_j_ += kTurnShare * kMostForce_n * radius_m_ * turn_rad;
  }
  /// @param r record of a step, @param after record of the next one, @param index the body
  void add(const TickRecord& r, const TickRecord& after, int index) {
    const Eigen::Vector3d v0 = r.bodies[index].velocity_m_s.eigen();
    const Eigen::Vector3d v1 = after.bodies[index].velocity_m_s.eigen();
    const Eigen::Vector3d v = 0.5 * (v0 + v1);
    const Eigen::Vector3d w = 0.5 * (r.bodies[index].angular_velocity_rad_s.eigen() +
                                     after.bodies[index].angular_velocity_rad_s.eigen());
    Eigen::Vector3d on_hand = Eigen::Vector3d::Zero();
    for (int i = 0; i < r.contact_count; ++i) {
      const Contact& c = r.contacts[i];
      if (c.body != index) continue;
      const Eigen::Vector3d arm = c.point_m.eigen() - r.bodies[index].position_m.eigen();
      given_j_ += 1e-3 * (c.force_n.eigen().dot(v + w.cross(arm)) + c.torque_nm.eigen().dot(w));
      on_hand += c.force_n.eigen();
    }
    const Eigen::Vector3d pull = mass_kg_ * (v1 - v0) / 1e-3 + on_hand;
    pulled_j_ += 1e-3 * pull.dot(v);
    most_pull_n = std::max(most_pull_n, pull.norm());
    pull_excess_j = std::max(pull_excess_j, pulled_j_ - pull_allowed_j_);
    const double allowed_j = pull_allowed_j_ + turn_allowed_j_;
    excess_j = std::max(excess_j, given_j_ - allowed_j);
    if (allowed_j > 0.0) share = std::max(share, given_j_ / allowed_j);
    if (pull_allowed_j_ > 0.0) pull_share = std::max(pull_share, pulled_j_ / pull_allowed_j_);
  }
  /// Keeps the larger of each figure.
  void take(const Ledger& other) {
    most_pull_n = std::max(most_pull_n, other.most_pull_n);
    excess_j = std::max(excess_j, other.excess_j);
    share = std::max(share, other.share);
    pull_excess_j = std::max(pull_excess_j, other.pull_excess_j);
    pull_share = std::max(pull_share, other.pull_share);
  }
  double most_pull_n = 0.0;
  double excess_j = 0.0,
         share = 0.0;  ///< energy given to the hand, over the allowed one; largest at any time
  double pull_excess_j = 0.0, pull_share = 0.0;  ///< work of the pull, over the allowed one

 private:
  double mass_kg_, radius_m_;
  double given_j_ = 0.0, pulled_j_ = 0.0, pull_allowed_j_ = 0.0, turn_allowed_j_ = 0.0;
};

/// A person who moves for three seconds and then rests, or who rests from the start.
Intention randomIntention(const DeviceModel& device, Draw& draw) {
  std::vector<Waypoint> way{{0.0, AxisPosition(device.axisCount())}};
  const bool moves = draw.chance(0.5);
  for (double t = 0.8; moves && t < 3.0; t += 0.7) {
    AxisPosition q(device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      q[a] = axis.lower + (axis.upper - axis.lower) * (0.3 + 0.4 * draw.unit());
    }
    way.push_back({t, q});
  }
  return Intention::throughWaypoints(way);
}

struct Outcome {
  bool faulted = false;
  double noise_n = 1e9;  ///< noise of the rendered effort over the last 0.3 s
  double held_s = 0.0;   ///< time until the rendered effort was at rest, with the target at rest
  int touching = 0;      ///< ticks
  bool touching_at_end = false;
  Ledger ledger;
  [[nodiscard]] bool rests() const { return noise_n <= ContactResult::kRests_n; }
  [[nodiscard]] bool unstable() const { return faulted || !rests(); }
};

Outcome drive(Models models, Holder holder, Draw& draw, bool uncertified) {
  models.scene.game.least_kg = 0.01;  // smallest value that a file may allow
  attach(holder, models, draw);
  RigOptions options;
  options.uncertified = uncertified;
  Intention intention = randomIntention(models.device, draw);
  Game game(std::move(models), std::move(intention), options);
  Body body = randomBody(game.rig->models.scene.game, draw);
  game.prepare(0, {body.shape});
  game.run(200);
  const Path path = randomPath(game.palm(), kMostMomentum_ns / body.order.mass_kg, draw);
  body.order.pose = poseAt(path.at_m.front(), path.turn.front());
  game.order(spawnCommand(body.order));
  game.run(2);
  const std::uint64_t from = game.ticks;
  Outcome out{.ledger = Ledger(body.order.mass_kg, body.radius_m)};
  const int index = static_cast<int>(game.rig->models.scene.bodies.size());
  Eigen::Vector3d at = path.at_m.front();
  Eigen::Quaterniond turn = path.turn.front();
  TickRecord last;
  const auto step = [&] {
    last = game.record;
    game.tick();
    if (any(game.record.faults & kStoppingFaults)) out.faulted = true;
    if (last.contact_count > 0) ++out.touching;
    if (last.tick >= from) out.ledger.add(last, game.record, index);
  };
  const auto aim = [&](const Eigen::Vector3d& to, const Eigen::Quaterniond& turned) {
    out.ledger.targetMoved((to - at).norm(), turn.angularDistance(turned));
    at = to, turn = turned;
    game.order(bodyTargetCommand(0, 1, poseAt(at, turn)));
  };
  for (std::size_t i = 0; i + 1 < path.at_m.size(); ++i) {
    for (int k = 0; k < path.ticks[i]; ++k) {
      const double u = static_cast<double>(k) / path.ticks[i];
      if (k % kFrame == 0) {
        aim(path.at_m[i] + u * (path.at_m[i + 1] - path.at_m[i]),
            path.turn[i].slerp(u, path.turn[i + 1]));
      }
      step();
    }
  }
  for (int k = 0; k < kLeastHold || (k < kMostHold && !out.rests()); k += kWindow) {
    if (out.faulted) break;
    FeltNoise noise(game.rig->models.device);
    for (int i = 0; i < kWindow; ++i) {
      if ((k + i) % kFrame == 0) aim(path.at_m.back(), path.turn.back());
      step();
      noise.add(game.record);
    }
    out.noise_n = noise.worst();
    out.held_s = 1e-3 * (k + kWindow);
  }
  out.touching_at_end = game.forceOf(0).norm() > 0.0;
  return out;
}

TEST(CertifiedDriven, RandomGainsPersonsAndDrivenBodies_AreNeverUnstable) {
  Draw draw(4310);
  const int sets = cases(9);
  int number = 0, unstable = 0, touched = 0, pressed = 0;
  double longest_s = 0.0;
  Ledger worst(0.0, 0.0);
  for (int n = 0; n < sets; ++n) {
    const Models models = certifiedModels(draw);
    for (const Holder holder :
         {Holder::kNobody, Holder::kRelaxed, Holder::kStiff, Holder::kAnybody}) {
      SCOPED_TRACE(testing::Message() << "set " << n << ", person " << static_cast<int>(holder));
      ++number;
      const Outcome out = drive(models, holder, draw, false);
      if (out.unstable()) {
        ++unstable;
        ADD_FAILURE() << (out.faulted ? "stopped" : "does not rest") << ", felt noise "
                      << out.noise_n << " N";
      }
      touched += out.touching > 0 ? 1 : 0;
      pressed += out.touching_at_end ? 1 : 0;
      longest_s = std::max(longest_s, out.held_s);
      worst.take(out.ledger);
    }
  }
  figure("certified gains with driven bodies", number, "cases");
  figure("of them unstable", unstable, "cases");
  figure("bodies that met the hand", touched, "cases");
  figure("bodies that press it at the end", pressed, "cases");
  figure("longest time until the felt effort rests", longest_s, "s");
  figure("largest pull", worst.most_pull_n, "N");
  figure("work of the pull, of 0.9 F_max times the way of the target", worst.pull_share, "1");
  figure("energy given to the hand, of F_max times the way of the target", worst.share, "1");
  figure("work of the pull beyond that", worst.pull_excess_j, "J");
  figure("energy given beyond that", worst.excess_j, "J");
  EXPECT_EQ(unstable, 0);
  if (kStatisticsMeaningful) {
    EXPECT_GT(pressed, 0);
    EXPECT_GT(touched, number / 2);
  }
  EXPECT_LE(worst.most_pull_n, (1.0 - kTurnShare) * kMostForce_n + tolerance(1e-9));
  EXPECT_LE(worst.pull_excess_j, tolerance(1e-9));
  EXPECT_LE(worst.excess_j, tolerance(1e-9));
}

TEST(CertifiedDriven, GainsFarFromCertified_AreDetectedAsUnstable) {
  Draw draw(4311);
  const int kSets = kStatisticsMeaningful ? 8 : 1;
  int unstable = 0;
  for (int n = 0; n < kSets; ++n) {
    Models models = gameModels("lambda-pride");
    shuffle(models, draw);
    for (DeviceAxis& axis : models.device.axes) {
      axis.damping *= 0.01;
      axis.coulomb = axis.encoder_step = 0.0;
    }
    for (AxisRendering& gains : models.rendering.axes) gains.k_pm *= 6.0;
    unstable += drive(models, Holder::kNobody, draw, true).unstable() ? 1 : 0;
  }
  figure("unstable with six times the stiffness and a hundredth of the damping", unstable,
         "of 8 cases");
  if (kStatisticsMeaningful) {
    EXPECT_GT(unstable, 0) << "the judge would not show it";
  }
}

}  // namespace
}  // namespace wholehand::test
