// A mirrored world gives a left hand the mirrored forces of the right one: the order in which
// contacts are found and solved must not show.
#include "loop/physics/body_yard.hpp"
#include "support/figure.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kFriction = 0.3;

AxisPosition imageOf(AxisPosition q) {
  q[1] = -q[1];
  return q;
}

/// A target that swings sideways into what stands there while the fingers close.
AxisPosition sweeping(double t) {
  AxisPosition q(6);
  q[0] = 0.01 * std::sin(3.0 * t);
  q[1] = 0.06 * std::sin(4.0 * t);
  q[3] = 0.8 + 0.6 * std::sin(2.0 * t);
  q[4] = 0.6;
  q[5] = 0.3;
  return q;
}

Vector3d forceOn(const Bench& bench) {
  Vector3d sum_n = Vector3d::Zero();
  for (int i = 0; i < bench.touching.count; ++i) sum_n += bench.touching.points[i].force_n.eigen();
  return sum_n;
}

/// One or two things of any shape, one on the other, on a table beside a right hand, or one that
/// floats.
SceneModel anyScene(std::mt19937_64& random) {
  const double size_m = uniform(random, 0.04, 0.07), high_m = 2.0 * size_m;
  const bool floats = random() % 4 == 0;
  const auto any_shape = [&] {
    switch (random() % (floats ? 4 : 3)) {
      case 0:
        return boxShape({size_m, size_m, high_m});
      case 1:
        return meshShape({size_m, size_m, high_m});
      case 2:
        return roundShape(ShapeType::kCylinder, 0.5 * size_m, high_m);
      default:
        return roundShape(ShapeType::kSphere, 0.5 * size_m, 0.0);
    }
  };
  const Vector3d at_m(uniform(random, 0.06, 0.09), 0.045 + 0.6 * size_m,
                      uniform(random, -0.01, 0.01));
  const auto thing = [&](double up_m, const Eigen::Matrix3d& turn) {
    return bodyOf(any_shape(), at_m + up_m * Vector3d::UnitZ(), logUniform(random, 0.02, 0.5),
                  kFriction, turn);
  };
  if (floats) return weightless({thing(0.0, anyTurn(random))});
  const auto standing = [&] {
    return Eigen::AngleAxisd(uniform(random, 0.0, 2.0 * kPi), Vector3d::UnitZ()).toRotationMatrix();
  };
  SceneModel scene = weightless({thing(0.0, standing())});
  scene.gravity_m_s2 = {0.0, 0.0, -kGravity_m_s2};
  if (random() % 2 == 0) scene.bodies.push_back(thing(high_m, standing()));
  SceneBody table = ground(kFriction, 1.0);
  table.pose.translation_m += Vector3d(0.1, 0.0, at_m.z() - 0.5 * high_m);
  scene.bodies.push_back(table);
  return scene;
}

constexpr int kSteps = 500;

/// Forces on a hand that sweeps through a scene, as the right hand would feel them; empty when the
/// hand has no room there.
std::vector<Vector3d> forcesIn(const SceneModel& scene, bool left = false) {
  const Eigen::Matrix3d reflect = Vector3d(1.0, left ? -1.0 : 1.0, 1.0).asDiagonal();
  Bench bench("bullet", scene, left ? "adult-median-left" : "adult-median-right");
  const auto target = [&](int k) {
    const AxisPosition q = sweeping(k * kPeriod_s);
    return left ? imageOf(q) : q;
  };
  std::vector<Vector3d> forces_n;
  if (!bench.world->placeHand(target(0))) return forces_n;
  for (int k = 0; k < kSteps && !testing::Test::HasFatalFailure(); ++k) {
    bench.step(target(k), AxisVelocity(6));
    forces_n.push_back(reflect * forceOn(bench));
  }
  return forces_n;
}

double largest(const std::vector<Vector3d>& forces_n) {
  double most_n = 0.0;
  for (const Vector3d& force_n : forces_n) most_n = std::max(most_n, force_n.norm());
  return most_n;
}

/// Largest difference of two courses of forces [N].
double difference(const std::vector<Vector3d>& one, const std::vector<Vector3d>& other) {
  double most_n = 0.0;
  for (int k = 0; k < kSteps; ++k) most_n = std::max(most_n, (one.at(k) - other.at(k)).norm());
  return most_n;
}

/// Largest difference of a world's forces from those of the same world whose masses differ in their
/// last digits [N].
double magnified(const SceneModel& scene, const std::vector<Vector3d>& forces_n) {
  double most_n = 0.0;
  for (int k = 1; k <= 8; ++k) {
    SceneModel other = scene;
    for (SceneBody& body : other.bodies) body.mass_kg *= 1.0 + 4e-16 * k;
    most_n = std::max(most_n, difference(forces_n, forcesIn(other)));
  }
  return most_n;
}

// Equal but for rounding. A thing that rocks on its edge magnifies rounding: such a world differs
// as much from itself when its masses change in their last digits.
TEST(MirroredWorld, OfAnyThings_GivesMirroredForces) {
  std::mt19937_64 random(seed());
  std::vector<double> off;
  const int wanted = kReducedCounts ? 8 : fullCounts() ? 200 : 20;
  int beyond = 0, unexplained = 0;
  for (int i = 0; i < 20 * wanted && static_cast<int>(off.size()) < wanted; ++i) {
    const SceneModel scene = anyScene(random);
    const std::vector<Vector3d> right = forcesIn(scene);
    if (largest(right) <= 0.1) continue;
    SceneModel image = scene;
    mirror(image);
    const double off_n = difference(right, forcesIn(image, true));
    off.push_back(off_n / largest(right));
    if (off.back() <= 1e-3) continue;
    ++beyond;
    const double magnified_n = magnified(scene, right);
    if (magnified_n > 0.1 * off_n) continue;
    ++unexplained;
    ADD_FAILURE() << "draw " << i << " differs by " << 100.0 * off.back() << " %, from itself by "
                  << 100.0 * magnified_n / largest(right) << " %";
  }
  ASSERT_EQ(static_cast<int>(off.size()), wanted);
  std::sort(off.begin(), off.end());
  figure("mirrored worlds whose forces differ by more than 0.1 %", beyond, "");
  figure("of them, more than from themselves", unexplained, "");
  figure("mirrored worlds, force of the first half second, median", 100.0 * off[wanted / 2], "%");
  figure("the same, worst", 100.0 * off.back(), "%");
  EXPECT_LE(off[wanted / 4], 1e-6);
}

}  // namespace
}  // namespace wholehand::test
