// A real pendulum in the hand is a passive object: with 1.0005 of the damping that the certificate
// asks, no loop with a lossless person grows, whether the hand holds it or touches it now and then.
#include "certified_sets.hpp"
#include "certify/passivity.hpp"
#include "loop/control/axis_loop.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/body_joint.hpp"
#include "support/figure.hpp"
#include "worst_termination.hpp"

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81;
constexpr int kLoops = 150;
constexpr double kSlow_rad = 0.02;  // per tick; slower oscillations take too long in time

/// A point-like pendulum. @param weight slope m g L where it hangs, per unit of the avatar's
/// inertia
BodyJoint pendulum(double inertia, double weight) {
  SceneBody body;
  body.name = "pendulum";
  // A hinge at L above the centre of mass: I = m L² + the rest, m g L = weight.
  const double length_m = 0.5 * kGravity * inertia / weight;
  body.mass_kg = weight / (kGravity * length_m);
  const double rest = inertia - body.mass_kg * length_m * length_m;
  body.inertia_kg_m2 = rest * Eigen::Matrix3d::Identity();
  body.joint.emplace();
  body.joint->axis = Vector3d::UnitY();
  body.joint->point_m = {0.0, 0.0, length_m};
  return BodyJoint(body);
}

/// One axis as TerminatedAxis, but its object is a pendulum of the scene, moved as the engine moves
/// it. State: as there, without the force of the lossless mass, then q and q̇ of the pendulum.
class AxisWithPendulum {
 public:
  AxisWithPendulum(const AxisLoop& loop, const Termination& t, const BodyJoint& joint)
      : l_(loop), person_(loop, personOf(t)), joint_(joint) {}

  [[nodiscard]] Eigen::Index size() const { return person_.size() + 2; }

  /// @param holds the hand holds the pendulum in this tick
  [[nodiscard]] Eigen::VectorXd tick(const Eigen::VectorXd& s, bool holds) {
    const Eigen::Index axis = person_.size(), tail = axis - 5 - l_.delay_ticks;
    Eigen::VectorXd next(size());
    // Without an object the avatar moves freely; the pendulum changes its velocity.
    next.head(axis) = person_.tick(s.head(axis));
    joint_.put(s[axis], s[axis + 1]);
    joint_.predict({0.0, 0.0, -kGravity}, l_.period_s, holds);
    double rate = joint_.rate();
    if (holds) {
      const double free = next[tail + 3];
      const double impulse = (rate - free) / (1.0 + joint_.yield());
      next[tail + 3] = free + impulse;
      next[tail + 2] = s[tail + 2] + l_.period_s * next[tail + 3];
      rate -= joint_.yield() * impulse;
    }
    joint_.move(rate, l_.period_s);
    next[axis] = joint_.position();
    next[axis + 1] = joint_.rate();
    return next;
  }

  /// Spectral radius of the held pendulum where it hangs.
  [[nodiscard]] double radius() {
    constexpr double kSmall = 1e-5;
    Eigen::MatrixXd m(size(), size());
    for (Eigen::Index i = 0; i < size(); ++i) {
      m.col(i) = tick(kSmall * Eigen::VectorXd::Unit(size(), i), true) / kSmall;
    }
    return spectralRadius(m);
  }

 private:
  static Termination personOf(Termination t) {
    t.world = World::kEngine;
    t.rigid = false;
    t.held_mass = t.spring_per_s2 = 0.0;
    return t;
  }
  AxisLoop l_;
  TerminatedAxis person_;
  BodyJoint joint_;
};

/// A random loop with its worst lossless person and a pendulum that at the frequency of the worst
/// object acts as that object does.
struct Case {
  AxisLoop loop;
  Termination person;
  double inertia = 0.0, weight = 0.0;
};

Case anyCase(Draw& draw) {
  for (;;) {
    Case c;
    AxisLoop& l = c.loop;
    l = loopOf(0.5, 0.0, draw.upTo(3), draw.between(100.0, 3000.0), 0.0, draw.between(15.0, 100.0),
               draw.between(400.0, 4e4), draw.chance(0.15) ? 0.0 : draw.unit());
    l.phi_k_dm = draw.chance(0.2) ? 0.0 : draw.between(0.5, 20.0);
    l.period_s = 1e-3 / (1 << draw.upTo(3));
    l.k_ds_per_s = criticalDamping(l.k_ps_per_s2, l.period_s);
    const double required = requiredDamping(l);
    if (!(required > 0.01)) continue;
    l.mass = draw.between(10.0, 100.0) * required * l.period_s;
    c.person = worstTermination(l, World::kLossless);
    if (c.person.rigid || !isPassive(c.person)) continue;
    if (c.person.held_mass + c.person.spring_per_s2 == 0.0) continue;  // the worst object is none
    const double half = 0.5 * c.person.angle_rad;
    const double share = draw.between(0.05, 1.0);  // of the weight that the inertia has to balance
    const double per_weight =
        l.period_s * l.period_s / (4.0 * std::sin(half) * std::sin(half));  // I ω² = weight
    c.weight = share * (c.person.spring_per_s2 + c.person.held_mass / per_weight);
    c.inertia = c.person.held_mass;
    if (c.person.spring_per_s2 > 0.0) c.weight = (1.0 + share) * c.person.spring_per_s2;
    c.inertia += (c.weight - c.person.spring_per_s2) * per_weight;
    l.damping = required;
    return c;
  }
}

TEST(HeldPendulum, AtTheEdgeOfTheCertificate_DoesNotGrow) {
  Draw draw(76);
  double worst = 0.0;
  int grow = 0;
  for (int i = 0; i < cases(kLoops); ++i) {
    const Case c = anyCase(draw);
    for (const double share : {1.0005, 1.005, 1.02}) {
      AxisLoop l = c.loop;
      l.damping *= share;
      const double radius = AxisWithPendulum(l, c.person, pendulum(c.inertia, c.weight)).radius();
      worst = std::max(worst, radius - 1.0);
      grow += radius > 1.0 + 1e-9 ? 1 : 0;
    }
  }
  figure("pendulums held at 1.0005 to 1.02 of b_min that grow", grow, "");
  figure("the same, largest radius less 1", worst, "");
  EXPECT_EQ(grow, 0);
}

TEST(HeldPendulum, TouchedAtRandomTicks_DoesNotGrow) {
  Draw draw(77);
  int grow = 0;
  for (int i = 0; i < cases(3 * kLoops);) {
    const Case c = anyCase(draw);
    if (c.person.angle_rad < kSlow_rad) continue;
    AxisLoop l = c.loop;
    l.damping *= std::array{1.0005, 1.005, 1.02}[i++ % 3];
    AxisWithPendulum axis(l, c.person, pendulum(c.inertia, c.weight));
    Eigen::VectorXd state = Eigen::VectorXd::Zero(axis.size());
    state[1] = 0.01;
    bool holds = true;
    double early = 0.0, late = 0.0;
    constexpr int kTicks = 8000, kWindow = kTicks / 8;
    // It lets go for some ticks now and then, or as often as it takes hold.
    const double lets_go = draw.between(1e-3, 0.1);
    for (int k = 0; k < kTicks; ++k) {
      if (draw.chance(holds ? lets_go : 0.1)) holds = !holds;
      state = axis.tick(state, holds);
      const double moves = std::abs(state[1]);
      if (k < kWindow) early = std::max(early, moves);
      if (k >= kTicks - kWindow) late = std::max(late, moves);
    }
    grow += late > early ? 1 : 0;
  }
  figure("pendulums touched at random ticks that grow", grow, "");
  EXPECT_EQ(grow, 0);
}

}  // namespace
}  // namespace wholehand::test
