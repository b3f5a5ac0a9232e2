// What nothing pushes comes to rest, and its energy only falls: towers of cubes of any masses,
// alone and under a fingertip.
#include "loop/physics/body_yard.hpp"
#include "loop/physics/still_hand.hpp"
#include "support/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kEdge_m = 0.04;
constexpr double kGives_m = 1e-5;  // SolverSettings::penetration_slop_m

/// A tower that gets nudged: cubes one on the other, the first below.
struct Tower {
  std::vector<double> masses_kg;
  double rate_hz = 1000.0;
  double aside_rad = 0.0;  ///< direction of the nudge
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();

  [[nodiscard]] int count() const { return static_cast<int>(masses_kg.size()); }
  /// m g of the whole tower [N].
  [[nodiscard]] double weight_n() const {
    return kGravity_m_s2 * std::accumulate(masses_kg.begin(), masses_kg.end(), 0.0);
  }
  /// The ground and the cubes, above z = 0.
  [[nodiscard]] std::vector<SceneBody> bodies() const {
    std::vector<SceneBody> out{ground(0.8)};
    for (int k = 1; k <= count(); ++k) {
      out.push_back(bodyOf(boxShape(Vector3d::Constant(kEdge_m)), {0.0, 0.0, kEdge_m * (k - 0.5)},
                           masses_kg[k - 1], 0.8));
    }
    return out;
  }
  /// Velocity of the nudge, in the tower's frame.
  [[nodiscard]] Vector3d nudge_m_s() const {
    return 1e-3 * Vector3d(std::cos(aside_rad), std::sin(aside_rad), 0.0);
  }
};

/// What a tower did after the nudge.
struct Course {
  double rests_after_s = 0.0;  ///< last time at which a body was not still
  double risen_j = 0.0;        ///< sum of all rises of energy
  double sunk_m = 0.0, walked_m = 0.0;
  double load_n = 0.0;  ///< weight of the tower, and what presses it

  /// The energy that lifts the load by 10 µm is one.
  [[nodiscard]] double risen() const { return risen_j / (load_n * 1e-5); }
  [[nodiscard]] bool obeys() const {
    return rests_after_s <= 2.0 && risen() <= 1.0 && sunk_m <= 1e-4 && walked_m <= 1e-4;
  }
  [[nodiscard]] std::string text() const {
    return fmt::format(
        "rests after {:.3g} s, energy rises by {:.3g} of 10 µm, sinks {:.3g} mm, walks {:.3g} mm",
        rests_after_s, risen(), 1e3 * sunk_m, 1e3 * walked_m);
  }
};

/// Sees a tower in each step after the nudge.
class Watch {
 public:
  /// @param frame of the tower: z is upwards, the ground is z = 0 @param first its lowest cube
  Watch(const Tower& tower, const Pose& frame, int first)
      : tower_(tower), frame_(frame), first_(first), from_(tower.masses_kg.size()) {
    course_.load_n = tower.weight_n();
  }
  void begin(const PhysicsState& state, double further_j = 0.0) {
    for (int k = 0; k < tower_.count(); ++k) from_[k] = at(state, k);
    energy_j_ = energyOf(state) + further_j;
  }
  /// @param further_j energy of what presses the tower
  void observe(const PhysicsState& state, double further_j = 0.0) {
    ++steps_;
    const double now_j = energyOf(state) + further_j;
    course_.risen_j += std::max(0.0, now_j - energy_j_);
    energy_j_ = now_j;
    for (int k = 0; k < tower_.count(); ++k) {
      const BodyState& body = state.bodies[first_ + k];
      if (body.velocity_m_s.eigen().norm() < 5e-4 &&
          body.angular_velocity_rad_s.eigen().norm() < 0.0125) {
        continue;
      }
      course_.rests_after_s = steps_ / tower_.rate_hz;
    }
  }
  [[nodiscard]] Course end(const PhysicsState& state, double pressed_n = 0.0) {
    course_.load_n += pressed_n;
    for (int k = 0; k < tower_.count(); ++k) {
      const Vector3d moved = at(state, k) - from_[k];
      course_.walked_m = std::max(course_.walked_m, std::hypot(moved.x(), moved.y()));
      // Each contact gives by kGives_m before it presses.
      const double stands_m = (k + 1) * (kEdge_m - kGives_m) - 0.5 * kEdge_m;
      course_.sunk_m = std::max(course_.sunk_m, stands_m - at(state, k).z());
    }
    return course_;
  }

 private:
  [[nodiscard]] Vector3d at(const PhysicsState& state, int k) const {
    return frame_.rotation.transpose() *
           (state.bodies[first_ + k].position_m.eigen() - frame_.translation_m);
  }
  /// Kinetic and potential energy. A cube's inertia is the same about every axis.
  [[nodiscard]] double energyOf(const PhysicsState& state) const {
    double sum_j = 0.0;
    for (int k = 0; k < tower_.count(); ++k) {
      const BodyState& body = state.bodies[first_ + k];
      sum_j += tower_.masses_kg[k] *
               (0.5 * body.velocity_m_s.eigen().squaredNorm() + kGravity_m_s2 * at(state, k).z() +
                kEdge_m * kEdge_m / 12.0 * body.angular_velocity_rad_s.eigen().squaredNorm());
    }
    return sum_j;
  }

  const Tower& tower_;
  Pose frame_;
  int first_, steps_ = 0;
  std::vector<Vector3d> from_;
  double energy_j_ = 0.0;
  Course course_;
};

/// A tower alone.
Course nudge(const Tower& tower, double seconds) {
  Yard yard("bullet", tower.bodies(), {0.0, 0.0, -kGravity_m_s2}, tower.rate_hz, tower.turn, false);
  yard.run(0.5);
  Watch watch(tower, {tower.turn, tower.turn * Vector3d(12.0, 0.0, 0.0)}, 1);
  yard.throwBody(tower.count(), tower.nudge_m_s());
  watch.begin(yard.seen());
  for (int i = 0; i < static_cast<int>(std::lround(seconds * tower.rate_hz)); ++i) {
    yard.step();
    watch.observe(yard.seen());
  }
  return watch.end(yard.seen());
}

/// The centre of the capsule's end that reaches furthest along a direction.
Vector3d furthest(const HandModel& hand, const Vector3d& along) {
  const ArticulatedBody body = handAt(hand, AxisPosition(hand.axis_count));
  Vector3d out = Vector3d::Zero();
  double most_m = -kInfinity;
  for (const Capsule& c : hand.capsules) {
    for (const Vector3d& end : {c.a_m, c.b_m}) {
      const Vector3d at_m = body.linkPose(c.link) * end;
      if (along.dot(at_m) + c.radius_m <= most_m) continue;
      most_m = along.dot(at_m) + c.radius_m;
      out = at_m;
    }
  }
  return out;
}

/// A tower under the tip of a finger that points down and aims into it by a small distance.
struct Finger {
  double tilt_rad = 0.0, about_rad = 0.0;  ///< of the finger against the vertical
  double off_m = 0.0;                      ///< from the middle of the top cube, to a side
  double aim_m = 0.0;                      ///< how far into the cube it aims
};

/// Energy of the hand's motion and of the spring that pulls it to its target.
double energyOf(const Bench& bench, const AxisPosition& target) {
  double sum_j = 0.0;
  const AxisMatrix& inertia = bench.body.reducedInertia();
  const int axes = target.size();
  for (int a = 0; a < axes; ++a) {
    const double off = target[a] - bench.after.q_s[a];
    sum_j += 0.5 * 4e3 * inertia(a, a) * off * off;
    for (int b = 0; b < axes; ++b) {
      sum_j += 0.5 * inertia(a, b) * bench.after.qd_s[a] * bench.after.qd_s[b];
    }
  }
  return sum_j;
}

Course nudgeUnderFinger(const Tower& tower, const Finger& finger, double seconds) {
  // The fingers point along x.
  const Vector3d about(0.0, std::cos(finger.about_rad), std::sin(finger.about_rad));
  const Vector3d down = Eigen::AngleAxisd(finger.tilt_rad, about) * Vector3d::UnitX();
  const double height_m = tower.count() * (kEdge_m - kGives_m);
  Pose frame;
  frame.rotation = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), -down).toRotationMatrix();
  const AxisPosition at(6);
  const Vector3d tip_m = furthest(hand(), down);
  const double top_m = reach(hand(), at, down) - down.dot(tip_m);
  frame.translation_m =
      tip_m + down * (top_m + height_m) + frame.rotation * Vector3d(finger.off_m, 0.0, 0.0);
  SceneModel scene;
  scene.gravity_m_s2 = kGravity_m_s2 * down;
  scene.bodies = tower.bodies();
  for (SceneBody& body : scene.bodies) body.pose = frame * body.pose;
  Bench bench("bullet", std::move(scene));
  BulletSettings settings;
  settings.lets_rest = false;
  bench.world = std::make_unique<BulletWorld>(bench.models.hand, bench.scene, settings);
  bench.period_s = 1.0 / tower.rate_hz;
  EXPECT_TRUE(bench.world->placeHand(at));
  AxisPosition target = at;
  for (int a = 0; a < 3; ++a) target[a] += finger.aim_m * down[a];
  const int settles = static_cast<int>(std::lround(1.0 * tower.rate_hz));
  const int steps = settles + static_cast<int>(std::lround(seconds * tower.rate_hz));
  Watch watch(tower, frame, 1);
  double pressed_n = 0.0;
  for (int i = 0; i < steps && !testing::Test::HasFatalFailure(); ++i) {
    if (i == settles) {
      BodyPlacements placements;
      placements.count = 1;
      const int top = tower.count();
      placements.items[0] = {top, 0, bench.after.bodies[top].position_m,
                             bench.after.bodies[top].orientation_xyzw,
                             Vec3::from(Vector3d(frame.rotation * tower.nudge_m_s()))};
      bench.world->placeBodies(placements);
      bench.after = look(*bench.world);
      watch.begin(bench.after, energyOf(bench, target));
    }
    bench.step(target, AxisVelocity(6));
    if (i < settles) continue;
    double now_n = 0.0;
    for (int c = 0; c < bench.touching.count; ++c)
      now_n += bench.touching.points[c].force_n.eigen().norm();
    pressed_n = std::max(pressed_n, i > settles + 100 ? now_n : 0.0);
    watch.observe(bench.after, energyOf(bench, target));
  }
  EXPECT_GT(pressed_n, 0.0);
  return watch.end(bench.after, pressed_n);
}

/// Masses between a lightest and a hundred times as heavy, in any order; in a third of the draws
/// the heavier the higher.
std::vector<double> anyMasses(std::mt19937_64& random) {
  std::vector<double> masses_kg(2 + random() % 11);
  const double lightest_kg = logUniform(random, 0.002, 0.1);
  const double ratio = logUniform(random, 1.0, 100.0);
  for (double& mass_kg : masses_kg) {
    mass_kg = lightest_kg * std::pow(ratio, uniform(random, 0.0, 1.0));
  }
  if (random() % 3 == 0) std::sort(masses_kg.begin(), masses_kg.end());
  return masses_kg;
}

Tower anyTower(std::mt19937_64& random) {
  const std::array rates_hz{500.0, 1000.0, 2000.0, 4000.0, 8000.0};
  Tower tower{anyMasses(random)};
  tower.rate_hz = rates_hz[random() % (kReducedCounts ? 2 : rates_hz.size())];
  tower.aside_rad = uniform(random, 0.0, 2.0 * kPi);
  tower.turn = anyTurn(random);
  return tower;
}

Finger anyFinger(std::mt19937_64& random) {
  return {uniform(random, 0.0, 0.2), uniform(random, 0.0, 2.0 * kPi), uniform(random, -0.01, 0.01),
          logUniform(random, 2e-5, 1e-3)};
}

/// Draws towers, nudges them and tells the worst of what they did. Each draw has its own seed.
void expectRest(unsigned stream, int first, int count,
                const std::function<Course(Tower, std::mt19937_64&)>& run) {
  Course worst;
  double worst_risen = 0.0;
  for (int i = first; i < first + count; ++i) {
    std::seed_seq mixed{static_cast<unsigned>(seed()), static_cast<unsigned>(seed() >> 32U), stream,
                        static_cast<unsigned>(i)};
    std::mt19937_64 random(mixed);
    const Tower tower = anyTower(random);
    const Course course = run(tower, random);
    EXPECT_TRUE(course.obeys()) << fmt::format("draw {}: {} cubes of {:.4g} kg, {} Hz: {}", i,
                                               tower.count(), fmt::join(tower.masses_kg, " "),
                                               tower.rate_hz, course.text());
    worst.rests_after_s = std::max(worst.rests_after_s, course.rests_after_s);
    worst.sunk_m = std::max(worst.sunk_m, course.sunk_m);
    worst.walked_m = std::max(worst.walked_m, course.walked_m);
    worst_risen = std::max(worst_risen, course.risen());
  }
  figure("rests after, worst", worst.rests_after_s, "s");
  figure("rises of energy, of load times 10 µm, worst", worst_risen, "");
  figure("sinks, worst", 1e3 * worst.sunk_m, "mm");
  figure("walks, worst", 1e3 * worst.walked_m, "mm");
}

TEST(Towers, OfAnyMassesNudged_RestAndOnlyLoseEnergy) {
  expectRest(6101, 0, kReducedCounts ? 3 : 20,
             [](const Tower& tower, std::mt19937_64&) { return nudge(tower, 2.2); });
}

TEST(Towers, UnderAFingertipNudged_RestAndOnlyLoseEnergy) {
  expectRest(6103, 0, kReducedCounts ? 2 : 10, [](const Tower& tower, std::mt19937_64& random) {
    return nudgeUnderFinger(tower, anyFinger(random), 2.2);
  });
}

/// A twentieth of the large counts, so that they can be shared out: the parameter says which one.
class ManyTowers : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Twentieths, ManyTowers, testing::Range(0, 20));

TEST_P(ManyTowers, Nudged_RestAndOnlyLoseEnergy_slow) {
  expectRest(6101, 25 * GetParam(), 25,
             [](const Tower& tower, std::mt19937_64&) { return nudge(tower, 4.0); });
}

TEST_P(ManyTowers, UnderAFingertipNudged_RestAndOnlyLoseEnergy_slow) {
  expectRest(6103, 25 * GetParam(), 25, [](const Tower& tower, std::mt19937_64& random) {
    return nudgeUnderFinger(tower, anyFinger(random), 4.0);
  });
}

TEST_P(ManyTowers, Nudged_StandForAMinute_slow) {
  expectRest(6102, GetParam(), 1, [](Tower tower, std::mt19937_64&) {
    tower.rate_hz = 1000.0;
    return nudge(tower, 60.0);
  });
}

/// Masses grow by the same ratio from the lowest cube to the highest. docs/adr/0086 compares them.
TEST(Towers, HeavierUpwards_RestAndOnlyLoseEnergy) {
  struct Growing {
    int cubes;
    double lowest_kg, highest_kg;
  };
  const double tenth_kg = 0.01 * std::pow(1.7, 9);
  for (const Growing& growing : {Growing{4, 0.02, 0.5},
                                 {8, 0.02, 2.0},
                                 {12, 0.1, 0.1},
                                 {10, 0.01, tenth_kg},
                                 {8, 1e-3, 1.0}}) {
    Tower tower;
    tower.aside_rad = 0.3;
    for (int k = 0; k < growing.cubes; ++k) {
      tower.masses_kg.push_back(growing.lowest_kg * std::pow(growing.highest_kg / growing.lowest_kg,
                                                             k / (growing.cubes - 1.0)));
    }
    const std::string name = fmt::format("{} cubes, {:.3g} to {:.3g} kg", growing.cubes,
                                         growing.lowest_kg, growing.highest_kg);
    const Course course = nudge(tower, 3.0);
    EXPECT_TRUE(course.obeys()) << name << ": " << course.text();
    figure("rises of energy, of m g 10 µm: " + name, course.risen(), "");
  }
}

}  // namespace
}  // namespace wholehand::test
