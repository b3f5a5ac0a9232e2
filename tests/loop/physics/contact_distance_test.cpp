#include "loop/physics/segment_distance.hpp"
#include "support/constants.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

std::vector<Shape> shapes() {
  Shape box, sphere, cylinder, capsule;
  box.type = ShapeType::kBox;
  box.half_extents_m = {0.025, 0.04, 0.01};
  sphere.type = ShapeType::kSphere;
  sphere.radius_m = 0.03;
  cylinder.type = ShapeType::kCylinder;
  cylinder.radius_m = 0.025;
  cylinder.length_m = 0.12;
  capsule.type = ShapeType::kCapsule;
  capsule.radius_m = 0.01;
  capsule.length_m = 0.05;
  return {box, sphere, cylinder, capsule};
}

/// Minimum of signedDistance() along a segment by ternary search; the distance is convex along it.
double leastDistance_m(const Shape& shape, const Vector3d& a_m, const Vector3d& b_m) {
  const auto at = [&](double along) { return signedDistance(shape, a_m + along * (b_m - a_m)); };
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 120; ++i) {
    const double left = low + (high - low) / 3.0, right = high - (high - low) / 3.0;
    (at(left) < at(right) ? high : low) = at(left) < at(right) ? right : left;
  }
  return std::min({at(0.0), at(1.0), at(0.5 * (low + high))});
}

TEST(ContactDistance, RandomCapsules_GiveTheMinimumAlongTheirAxis) {
  auto random = seededRandom(371);
  std::uniform_real_distribution<double> where(-0.09, 0.09);
  for (const Shape& shape : shapes()) {
    for (int i = 0; i < 500; ++i) {
      const Vector3d a(where(random), where(random), where(random));
      const Vector3d b = a + 0.5 * Vector3d(where(random), where(random), where(random));
      const SegmentDistance is = contactDistance(shape, a, b, 0.008, kInfinity);
      ASSERT_NEAR(is.distance_m, leastDistance_m(shape, a, b) - 0.008, 1e-11)
          << "shape " << static_cast<int>(shape.type) << ", a " << a.transpose() << ", b "
          << b.transpose();
      if (is.distance_m < 0.0) continue;
      // A step along the normal increases the distance by its length.
      const Vector3d nearest = a + is.along * (b - a);
      EXPECT_NEAR(signedDistance(shape, nearest + 1e-3 * is.normal) - 0.008 - is.distance_m, 1e-3,
                  1e-9);
    }
  }
}

// A search that stops early must have found a distance beyond the limit; a near shape is never
// dropped.
TEST(ContactDistance, WithALimit_StopsEarlyOnlyBeyondIt) {
  auto random = seededRandom(372);
  std::uniform_real_distribution<double> where(-0.09, 0.09);
  int beyond = 0;
  for (const Shape& shape : shapes()) {
    for (int i = 0; i < 500; ++i) {
      const Vector3d a(where(random), where(random), where(random));
      const Vector3d b = a + 0.5 * Vector3d(where(random), where(random), where(random));
      const double exact_m = leastDistance_m(shape, a, b) - 0.008;
      const SegmentDistance is = contactDistance(shape, a, b, 0.008, 5e-4);
      EXPECT_LE(is.least_m, exact_m + 1e-11);
      if (exact_m > 5e-4) {
        EXPECT_GT(is.distance_m, 5e-4);
        ++beyond;
      } else {
        EXPECT_NEAR(is.distance_m, exact_m, 1e-11);
      }
    }
  }
  EXPECT_GT(beyond, 500);
}

// Exact to 0.1 µm, also where the nearest point is on an edge; 12 search steps left 2 µm there.
TEST(SegmentDistance, RandomCapsules_AreExactToATenthOfAMicrometre) {
  auto random = seededRandom(374);
  std::uniform_real_distribution<double> where(-0.09, 0.09);
  for (const Shape& shape : shapes()) {
    for (int i = 0; i < (kReducedCounts ? 500 : 8000); ++i) {
      const Vector3d a(where(random), where(random), where(random));
      const Vector3d b = a + 0.5 * Vector3d(where(random), where(random), where(random));
      const double exact_m = leastDistance_m(shape, a, b);
      if (exact_m < 0.0) continue;  // no nearest point
      ASSERT_NEAR(segmentDistance(shape, a, b, 0.0, 0.0).distance_m, exact_m, 1.01e-7)
          << "shape " << static_cast<int>(shape.type) << ", a " << a.transpose() << ", b "
          << b.transpose();
    }
  }
}

// The first-touch search relies on this bound: it never exceeds the distance, and along the capsule
// it never falls below the minimum. The distance itself equals signedDistance().
TEST(SegmentDistance, RandomPoint_IsNotBelowItsBound) {
  auto random = seededRandom(373);
  std::uniform_real_distribution<double> where(-0.09, 0.09);
  for (Shape shape : shapes()) {
    shape.in_body.rotation =
        Eigen::AngleAxisd(0.7, Vector3d(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
    shape.in_body.translation_m = {0.01, -0.02, 0.03};
    for (int i = 0; i < 500; ++i) {
      const Vector3d a(where(random), where(random), where(random));
      const Vector3d b = a + 0.5 * Vector3d(where(random), where(random), where(random));
      for (const double share : {0.0, 0.2}) {
        const SegmentDistance is = segmentDistance(shape, a, b, 0.008, share);
        const Vector3d nearest = a + is.along * (b - a);
        const auto bound = [&](const Vector3d& x) {
          return is.least_m + is.bound_normal.dot(x - nearest);
        };
        EXPECT_LE(is.bound_normal.norm(), 1.0 + 1e-12);
        EXPECT_GE(std::min(bound(a), bound(b)), is.least_m - 1e-12);
        for (int k = 0; k < 10; ++k) {
          const Vector3d x(where(random), where(random), where(random));
          ASSERT_GE(signedDistance(shape, x) - 0.008, bound(x) - 1e-12)
              << "shape " << static_cast<int>(shape.type) << ", a " << a.transpose() << ", b "
              << b.transpose() << ", at " << x.transpose();
        }
      }
    }
  }
}

// A finger that lies along a face touches at its nearer end.
TEST(ContactDistance, AlongAFace_IsAtTheNearerEnd) {
  const Shape box = shapes().front();
  const Vector3d a(-0.01, 0.0, 0.02), b(0.01, 0.0, 0.02);
  const Vector3d tilt(0.0, 0.0, 1e-9);
  EXPECT_EQ(contactDistance(box, a, b + tilt, 0.008, kInfinity).along, 0.0);
  EXPECT_EQ(contactDistance(box, a + tilt, b, 0.008, kInfinity).along, 1.0);
  EXPECT_NEAR(contactDistance(box, a, b, 0.008, kInfinity).distance_m, 0.002, 1e-15);
}

}  // namespace
}  // namespace wholehand::test
