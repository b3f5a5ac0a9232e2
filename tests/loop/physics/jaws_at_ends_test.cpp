// A joint at its end is a wall: what is wedged between such bodies is pressed by the depth of each
// contact, whatever their masses, shapes, orientation, joints, and the rate of the loop.
#include "loop/physics/body_yard.hpp"
#include "loop/physics/still_hand.hpp"
#include "support/figure.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// What stands beside the hand.
enum class Stands { kFixed, kAtEndOfSlide, kAtEndOfHinge };

/// A body with a flat face towards −z at z = 0, of any shape.
SceneBody anyFace(std::mt19937_64& random, double mass_kg) {
  const auto size_m = [&] { return uniform(random, 0.5, 0.9); };
  const double thick_m = uniform(random, 0.04, 0.2);
  const Vector3d middle_m(0.0, 0.0, 0.5 * thick_m), extent_m(size_m(), size_m(), thick_m);
  switch (random() % 3) {
    case 0:
      return bodyOf(boxShape(extent_m), middle_m, mass_kg, 0.5);
    case 1:
      return bodyOf(meshShape(extent_m), middle_m, mass_kg, 0.5);
    default:
      return bodyOf(roundShape(ShapeType::kCylinder, 0.5 * size_m(), thick_m), middle_m, mass_kg,
                    0.5);
  }
}

/// A body whose face is `face_m` from the origin and faces against `along`. On a joint it stands at
/// the end that keeps it from giving way.
SceneBody anyJaw(std::mt19937_64& random, Stands stands, const Vector3d& along, double face_m) {
  const double mass_kg = logUniform(random, 0.05, 5.0);
  SceneBody body = anyFace(random, mass_kg);
  const Matrix3d turn =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), along) *
      Eigen::AngleAxisd(uniform(random, 0.0, 2.0 * kPi), Vector3d::UnitZ()).toRotationMatrix();
  body.pose = {turn, face_m * along + turn * body.pose.translation_m};
  if (stands == Stands::kFixed) {
    body.fixed = true;
    return body;
  }
  // At +q it comes towards the hand.
  SceneJoint joint;
  joint.axis = -Vector3d::UnitZ();
  if (stands == Stands::kAtEndOfSlide) joint.type = SceneJoint::Type::kSlide;
  if (stands == Stands::kAtEndOfHinge) {
    joint.point_m = uniform(random, 0.3, 0.6) * Vector3d::UnitX();
    joint.axis = -Vector3d::UnitY();
  }
  joint.least = 0.0, joint.most = 0.05;
  if (random() % 2 == 0) {
    joint.axis = -joint.axis;
    joint.least = -0.05, joint.most = 0.0;
  }
  if (random() % 3 == 0) joint.dry_friction = uniform(random, 0.0, 0.2);
  body.joint = joint;
  return body;
}

/// Contacts of the hand in the last steps.
struct Wedged {
  int pressed = 0;
  double off = 0.0;  ///< largest error of a contact's force, relative to what its depth implies
  double most_n = 0.0;
};

Wedged wedge(SceneModel scene, double rate_hz) {
  Bench bench("bullet", std::move(scene));
  bench.period_s = 1.0 / rate_hz;
  EXPECT_TRUE(bench.world->placeHand(AxisPosition(6)));
  Wedged course;
  // What the first touch leaves in the forces decays by 0.4 % a step.
  const int steps = std::max(3000, static_cast<int>(0.5 * rate_hz));
  for (int k = 0; k < steps && !testing::Test::HasFatalFailure(); ++k) {
    bench.step(AxisPosition(6), AxisVelocity(6));
    if (k < steps - 50) continue;
    for (int c = 0; c < bench.touching.count; ++c) {
      const Contact& contact = bench.touching.points[c];
      // 2.5 N/µm beyond the 10 µm at which contacts rest.
      const double depth_n = 2.5e6 * std::max(0.0, -contact.distance_m - 1e-5);
      if (depth_n < 2.0) continue;
      ++course.pressed;
      const double force_n = contact.normal.eigen().dot(contact.force_n.eigen());
      course.most_n = std::max(course.most_n, force_n);
      course.off = std::max(course.off, std::abs(force_n / depth_n - 1.0));
    }
  }
  return course;
}

// Whatever presses the hand from two sides, each contact presses by its own depth. Where a jaw
// presses a digit against the end of the digit's own joint, this end bears as much.
TEST(JawsAtTheirEnds, PressTheHandByTheDepthAsWallsDo) {
  std::mt19937_64 random(seed());
  std::array<double, 3> worst{};
  int wedged = 0;
  const int count = kReducedCounts ? 4 : cases(20);
  for (int i = 0; i < count; ++i) {
    // Across the hand; in half of the cases tilted, so that the jaws meet other parts.
    const Vector3d about(uniform(random, -1.0, 1.0), 0.0, uniform(random, -1.0, 1.0));
    const double tilt_rad = i % 2 == 0 ? 0.0 : uniform(random, 0.0, 0.3);
    const Vector3d along = Eigen::AngleAxisd(tilt_rad, about.normalized()) * Vector3d::UnitY();
    const double depth_m = uniform(random, 2e-5, 4e-5);
    // The lower the rate, the more sweeps the forces need.
    const double rate_hz = i % 4 < 2 ? logUniform(random, 200.0, 340.0)
                                     : logUniform(random, 340.0, kReducedCounts ? 1000.0 : 8000.0);
    const std::array stands{static_cast<Stands>(random() % 3), static_cast<Stands>(random() % 3)};
    const auto jaw_of = [&](Stands which, const Vector3d& to) {
      return anyJaw(random, which, to, reach(hand(), AxisPosition(6), to) - depth_m);
    };
    const Wedged course =
        wedge(weightless({jaw_of(stands[0], along), jaw_of(stands[1], -along)}), rate_hz);
    const int kind = static_cast<int>(std::max(stands[0], stands[1]));
    EXPECT_LE(course.off, tolerance(0.01))
        << i << ", kind " << kind << ": " << course.most_n << " N, " << rate_hz << " Hz";
    wedged += course.pressed > 50 ? 1 : 0;
    worst[kind] = std::max(worst[kind], course.off);
  }
  // Tilted jaws may meet fingers, which make room.
  EXPECT_GE(wedged, count / 2);
  figure("hand between walls, force against depth, worst", 100.0 * worst[0], "%");
  figure("hand between a slide at its end and a wall or slide, the same", 100.0 * worst[1], "%");
  figure("hand between a hinge at its end and any, the same", 100.0 * worst[2], "%");
}

}  // namespace
}  // namespace wholehand::test
