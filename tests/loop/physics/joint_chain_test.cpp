// Trees of joints: laws of the coordinates alone, against a textbook's equations and by invariants.
#include "loop/physics/joint_chain.hpp"

#include "loop/physics/body_yard.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wholehand::test::trees {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

const Vector3d kDown(0.0, 0.0, -kGravity_m_s2);

Vector3d anyVector(std::mt19937_64& random) {
  return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
}

/// A rod that hangs from a hinge about y at its upper end.
SceneBody hangingRod(double length_m, double top_m, double mass_kg) {
  SceneBody rod =
      bodyOf(boxShape({0.01, 0.02, length_m}), {0, 0, top_m - 0.5 * length_m}, mass_kg, 0.5);
  rod.joint.emplace();
  rod.joint->axis = Vector3d::UnitY();
  rod.joint->point_m = {0, 0, 0.5 * length_m};
  return rod;
}

/// The double pendulum of two rods, and the equations of a textbook for it, in the rods' angles to
/// the vertical.
struct DoublePendulum {
  double length1_m, length2_m, mass1_kg, mass2_kg;

  [[nodiscard]] std::vector<SceneBody> bodies() const {
    std::vector<SceneBody> rods{hangingRod(length1_m, 0.0, mass1_kg),
                                hangingRod(length2_m, -length1_m, mass2_kg)};
    rods[1].joint->parent = 0;
    return rods;
  }
  /// Largest difference of the potential [J].
  [[nodiscard]] double range_j() const {
    return kGravity_m_s2 * (mass1_kg * length1_m + mass2_kg * (2.0 * length1_m + length2_m));
  }
  using State = Eigen::Vector4d;  ///< both angles, both rates
  [[nodiscard]] State rates(const State& s) const {
    const auto moment = [](double mass_kg, double length_m) {
      return mass_kg * (length_m * length_m / 3.0 + 0.01 * 0.01 / 12.0);
    };
    const double a1 = 0.5 * length1_m, a2 = 0.5 * length2_m;
    const double m11 = moment(mass1_kg, length1_m) + mass2_kg * length1_m * length1_m;
    const double m22 = moment(mass2_kg, length2_m);
    const double c = mass2_kg * length1_m * a2, apart = s[0] - s[1];
    const double m12 = c * std::cos(apart), g = kGravity_m_s2;
    const double f1 = -c * std::sin(apart) * s[3] * s[3] -
                      g * std::sin(s[0]) * (mass1_kg * a1 + mass2_kg * length1_m);
    const double f2 = c * std::sin(apart) * s[2] * s[2] - g * std::sin(s[1]) * mass2_kg * a2;
    const double det = m11 * m22 - m12 * m12;
    return {s[2], s[3], (m22 * f1 - m12 * f2) / det, (m11 * f2 - m12 * f1) / det};
  }
  /// The state after a time: steps of 0.1 ms of Runge and Kutta, whose error is 10⁴ times smaller
  /// than that of the chain's.
  [[nodiscard]] State after(State s, double time_s) const {
    constexpr double kStep_s = 1e-4;
    for (int i = 0; i < static_cast<int>(std::lround(time_s / kStep_s)); ++i) {
      const State a = rates(s), b = rates(s + 0.5 * kStep_s * a), c = rates(s + 0.5 * kStep_s * b);
      s += kStep_s / 6.0 * (a + 2.0 * b + 2.0 * c + rates(s + kStep_s * c));
    }
    return s;
  }
};

DoublePendulum anyPendulum(std::mt19937_64& random) {
  return {uniform(random, 0.15, 0.4), uniform(random, 0.15, 0.4), logUniform(random, 0.1, 1.0),
          logUniform(random, 0.1, 1.0)};
}

void step(JointChain& chain, const Vector3d& gravity_m_s2, double step_s) {
  chain.predict(gravity_m_s2, step_s, false);
  chain.move(chain.rate(), step_s);
}

TEST(JointChain, DoublePendulum_TakesThePathOfTheTextbookForASecond) {
  std::mt19937_64 random(seed());
  double worst = 0.0;
  for (int i = 0; i < cases(10); ++i) {
    const DoublePendulum pendulum = anyPendulum(random);
    JointChain chain(pendulum.bodies(), {0, 1});
    const Vector3d start(uniform(random, -170.0, 170.0) * kDeg,
                         uniform(random, -170.0, 170.0) * kDeg, 0.0);
    chain.put(start, Vector3d::Zero());
    for (int k = 0; k < 1000; ++k) step(chain, kDown, 1e-3);
    // A rod turns about +y from the vertical as the chain does; the second one from the first.
    const auto there = pendulum.after({start[0], start[0] + start[1], 0.0, 0.0}, 1.0);
    worst = std::max({worst, std::abs(chain.position()[0] - there[0]),
                      std::abs(chain.position()[0] + chain.position()[1] - there[1])});
  }
  figure("double pendulum, off the textbook's path after 1 s, worst", worst, "rad");
  EXPECT_LE(worst, 1e-3);
}

TEST(JointChain, DoublePendulumFrom170Degrees_KeepsItsEnergyFor10s) {
  std::mt19937_64 random(seed());
  double worst = 0.0;
  for (int i = 0; i < cases(10); ++i) {
    const DoublePendulum pendulum = anyPendulum(random);
    JointChain chain(pendulum.bodies(), {0, 1});
    chain.put({170.0 * kDeg, uniform(random, -170.0, 170.0) * kDeg, 0.0}, Vector3d::Zero());
    const double begun_j = chain.energy(kDown);
    double moved = 0.0;
    for (int k = 0; k < 10'000; ++k) {
      step(chain, kDown, 1e-3);
      worst = std::max(worst, std::abs(chain.energy(kDown) - begun_j) / pendulum.range_j());
      moved = std::max(moved, chain.rate().norm());
    }
    EXPECT_GT(moved, 3.0);
  }
  figure("double pendulum, energy in 10 s, worst share of the potential's range", worst, "");
  EXPECT_LE(worst, 1e-3);
}

/// A tree of hinges and slides in any directions: a chain, a fork, or with a joint that follows.
struct Tree {
  std::vector<SceneBody> bodies;
  std::vector<int> members;
  int coordinates = 0;
};

Tree anyTree(std::mt19937_64& random) {
  Tree tree;
  const int count = 2 + static_cast<int>(random() % 3);
  for (int i = 0; i < count; ++i) {
    const Vector3d size_m(logUniform(random, 0.02, 0.2), logUniform(random, 0.02, 0.2),
                          logUniform(random, 0.02, 0.2));
    SceneBody body = bodyOf(boxShape(size_m), 0.2 * anyVector(random),
                            logUniform(random, 0.05, 2.0), 0.5, anyTurn(random));
    body.com_m = 0.03 * anyVector(random);
    body.joint.emplace();
    body.joint->type = random() % 3 == 0 ? SceneJoint::Type::kSlide : SceneJoint::Type::kHinge;
    body.joint->axis = anyVector(random).normalized();
    body.joint->point_m = 0.2 * anyVector(random);
    if (i > 0 && random() % 3 != 0) {
      body.joint->parent = static_cast<int>(random() % static_cast<unsigned>(i));
    }
    const bool follows = tree.coordinates == 3 || (i > 0 && random() % 3 == 0);
    if (follows) {
      body.joint->follows = 0;  // the first one leads
      body.joint->ratio = uniform(random, 0.2, 2.0) * (random() % 2 == 0 ? 1.0 : -1.0);
    } else {
      ++tree.coordinates;
    }
    tree.members.push_back(i);
    tree.bodies.push_back(body);
  }
  return tree;
}

Vector3d anyRates(std::mt19937_64& random, int coordinates, double most) {
  Vector3d rates = Vector3d::Zero();
  for (int k = 0; k < coordinates; ++k) rates[k] = uniform(random, -most, most);
  return rates;
}

/// Pose of every link at q.
std::vector<Pose> posesAt(JointChain& chain, const Vector3d& q) {
  chain.put(q, Vector3d::Zero());
  std::vector<Pose> poses;
  for (int i = 0; i < chain.links(); ++i) poses.push_back(chain.pose(i));
  return poses;
}

// What a force on a point of any link does to a coordinate is its virtual work: the force times the
// way of that point, here from poses at two near positions.
TEST(JointChain, ForceOnAPointOfALink_DoesItsVirtualWork) {
  std::mt19937_64 random(seed() + 1);
  double worst = 0.0;
  for (int i = 0; i < cases(100); ++i) {
    const Tree tree = anyTree(random);
    JointChain chain(tree.bodies, tree.members);
    ASSERT_EQ(chain.coordinates(), tree.coordinates);
    const Vector3d q = anyRates(random, tree.coordinates, 2.0);
    // A difference of the fourth order: its error is of 1e-12.
    constexpr double kWay = 1e-3;
    for (int k = 0; k < tree.coordinates; ++k) {
      const Vector3d unit = Vector3d::Unit(k);
      const auto far_back = posesAt(chain, q - 2.0 * kWay * unit),
                 back = posesAt(chain, q - kWay * unit);
      const auto on = posesAt(chain, q + kWay * unit),
                 far_on = posesAt(chain, q + 2.0 * kWay * unit);
      chain.put(q, Vector3d::Zero());
      for (int link = 0; link < chain.links(); ++link) {
        const Vector3d in_link = 0.2 * anyVector(random), force = anyVector(random);
        const auto at = [&](const std::vector<Pose>& poses) { return poses[link] * in_link; };
        const Vector3d way =
            (8.0 * (at(on) - at(back)) - (at(far_on) - at(far_back))) / (12.0 * kWay);
        const Vector3d com_m = chain.pose(link) * tree.bodies[link].com_m;
        const Vector3d arm_m = chain.pose(link) * in_link - com_m;
        const double does = chain.project(link, force, arm_m.cross(force))[k];
        worst = std::max(worst, std::abs(does - force.dot(way)));
      }
    }
  }
  figure("force on a link, off its virtual work, worst", worst, "N·m per N");
  EXPECT_LE(worst, 1e-9);
}

// Lagrange's equations, d/dt ∂T/∂q̇ − ∂T/∂q = −∂V/∂q, by differences of the energies alone.
TEST(JointChain, AnyTree_AcceleratesAsItsEnergiesSay) {
  std::mt19937_64 random(seed() + 2);
  double worst = 0.0;
  for (int i = 0; i < cases(50); ++i) {
    const Tree tree = anyTree(random);
    JointChain chain(tree.bodies, tree.members);
    const int n = tree.coordinates;
    const Vector3d q = anyRates(random, n, 2.0), rate = anyRates(random, n, 5.0);
    const auto energy = [&](const Vector3d& at, const Vector3d& moving, const Vector3d& gravity) {
      chain.put(at, moving);
      return chain.energy(gravity);
    };
    const auto kinetic = [&](const Vector3d& at, const Vector3d& moving) {
      return energy(at, moving, Vector3d::Zero());
    };
    constexpr double kWay = 1e-4;
    const auto slope = [&](auto of) {
      Vector3d result = Vector3d::Zero();
      for (int k = 0; k < n; ++k) {
        const Vector3d d = kWay * Vector3d::Unit(k);
        result[k] = (8.0 * (of(d) - of(-d)) - (of(2.0 * d) - of(-2.0 * d))) / (12.0 * kWay);
      }
      return result;
    };
    // T is quadratic in the rates: p = ∂T/∂q̇ is exact by any difference.
    const auto momentum = [&](const Vector3d& at) {
      return slope([&](const Vector3d& d) { return kinetic(at, rate + d); });
    };
    const Vector3d along = (8.0 * (momentum(q + kWay * rate) - momentum(q - kWay * rate)) -
                            (momentum(q + 2.0 * kWay * rate) - momentum(q - 2.0 * kWay * rate))) /
                           (12.0 * kWay);
    const Vector3d force = slope([&](const Vector3d& d) {
      return 2.0 * kinetic(q + d, rate) - energy(q + d, rate, kDown);  // T − V
    });
    // M q̈ = ∂(T − V)/∂q − Ṁ q̇
    chain.put(q, rate);
    constexpr double kStep_s = 1e-3;
    chain.predict(kDown, kStep_s, true);
    const Vector3d change = (chain.rate() - rate) / kStep_s;
    Vector3d inertial = Vector3d::Zero();
    for (int k = 0; k < n; ++k) {
      // M q̈ from the kinetic energy: the momentum at q̈ as a rate.
      const Vector3d d = Vector3d::Unit(k);
      inertial[k] = 0.5 * (kinetic(q, change + d) - kinetic(q, change - d));
    }
    const Vector3d off = inertial - (force - along);
    worst = std::max(worst, off.norm() / (force.norm() + along.norm() + 1e-3));
  }
  figure("acceleration of a tree, off Lagrange's equations, worst share", worst, "");
  EXPECT_LE(worst, 1e-5);
}

// Whatever touches a tree, at whatever steps, with friction and ends: H never grows by more than
// the impulses' work.
TEST(JointChain, PushedAtRandomSteps_GetsNoMoreThanItWasGiven) {
  std::mt19937_64 random(seed() + 3);
  double worst = -1e300, most = 0.0;
  for (int i = 0; i < cases(50); ++i) {
    Tree tree = anyTree(random);
    const bool rubs = random() % 2 == 0;
    for (SceneBody& body : tree.bodies) {
      if (rubs) body.joint->viscous_friction = logUniform(random, 1e-4, 1.0);
      if (random() % 4 == 0) body.joint->least = -1.0, body.joint->most = 1.0;
    }
    JointChain chain(tree.bodies, tree.members);
    const double step_s = 1.0 / logUniform(random, 500.0, 8000.0);
    chain.put(Vector3d::Zero(), anyRates(random, tree.coordinates, 3.0));
    for (int k = 0; k < 400; ++k) {
      const double before_j = chain.energy(kDown);
      const bool touched = random() % 3 == 0;
      chain.predict(kDown, step_s, touched);
      const Vector3d free = chain.rate();
      Vector3d rate = free;
      double work_j = 0.0;
      for (int c = 0; c < tree.coordinates; ++c) {
        if (touched) rate[c] += uniform(random, -0.2, 0.2);
        rate[c] = std::clamp(rate[c], chain.leastRate()[c], chain.mostRate()[c]);
      }
      if (rate != free) {
        const Matrix3d of = chain.mobility().topLeftCorner(3, 3);
        const int n = tree.coordinates;
        const Eigen::VectorXd impulse =
            of.topLeftCorner(n, n).fullPivLu().solve((rate - free).head(n).eval());
        work_j = impulse.dot(rate.head(n));
      }
      chain.move(rate, step_s);
      const double scale = std::abs(before_j) + std::abs(work_j) + 1.0;
      worst = std::max(worst, (chain.energy(kDown) - before_j - work_j) / scale);
      most = std::max(most, std::abs(work_j));
    }
  }
  figure("energy of a pushed tree beyond what it got, worst share", worst, "");
  EXPECT_GT(most, 1e-3);
  EXPECT_LE(worst, 1e-11);
}

TEST(JointChain, JointThatFollows_GoesItsRatioWhateverMoves) {
  std::vector<SceneBody> jaws{hangingRod(0.1, 0.0, 0.1), hangingRod(0.1, 0.0, 0.2)};
  jaws[1].joint->follows = 0, jaws[1].joint->ratio = -0.5;
  JointChain chain(jaws, {0, 1});
  ASSERT_EQ(chain.coordinates(), 1);
  chain.put({1.0, 0.0, 0.0}, {0.5, 0.0, 0.0});
  for (int k = 0; k < 500; ++k) {
    step(chain, kDown, 1e-3);
    const auto angle = [&](int link) {
      const Vector3d down = chain.pose(link).rotation * -Vector3d::UnitZ();
      return std::atan2(-down.x(), -down.z());
    };
    ASSERT_NEAR(std::sin(angle(1) + 0.5 * angle(0)), 0.0, 1e-14);
  }
  EXPECT_GT(std::abs(chain.position()[0] - 1.0), 0.1);
}

}  // namespace
}  // namespace wholehand::test::trees
