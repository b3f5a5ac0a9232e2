#include "files/mesh/convex_mesh.hpp"
#include "files/scene/separation.hpp"
#include "loop/core/geometry.hpp"
#include "support/capsule_shape.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace wholehand::test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

Shape box(const Vector3d& size_m) {
  Shape s;
  s.half_extents_m = size_m / 2.0;
  return s;
}
Shape round(ShapeType type, double radius_m, double length_m = 0.0) {
  Shape s;
  s.type = type;
  s.radius_m = radius_m;
  s.length_m = length_m;
  return s;
}

/// A box as a mesh: eight corners, twelve triangles of mixed winding.
Shape boxMesh(const Vector3d& size_m) {
  std::vector<Vector3d> p;
  for (int i = 0; i < 8; ++i) {
    p.emplace_back((i & 1 ? 0.5 : -0.5) * size_m.x(), (i & 2 ? 0.5 : -0.5) * size_m.y(),
                   (i & 4 ? 0.5 : -0.5) * size_m.z());
  }
  const std::vector<Eigen::Vector3i> t{{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6},
                                       {0, 1, 5}, {0, 5, 4}, {2, 3, 7}, {2, 7, 6},
                                       {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  Expected<Shape> mesh = convexMesh(p, t);
  return mesh.ok() ? *mesh : Shape{};
}

/// One shape of each type, translated and rotated in its body's frame.
std::vector<Shape> oneOfEach() {
  std::vector<Shape> shapes{box({0.05, 0.03, 0.08}), round(ShapeType::kSphere, 0.03),
                            round(ShapeType::kCylinder, 0.025, 0.12),
                            round(ShapeType::kCapsule, 0.02, 0.05), boxMesh({0.04, 0.06, 0.02})};
  for (Shape& s : shapes) {
    s.in_body.rotation = rotationFromRpy(0.4, -0.7, 1.9);
    s.in_body.translation_m = {0.01, -0.02, 0.03};
  }
  return shapes;
}

Pose at(double x_m, double y_m, double z_m) {
  Pose pose;
  pose.translation_m = {x_m, y_m, z_m};
  return pose;
}

Pose randomPose(std::mt19937_64& random, double reach_m) {
  std::uniform_real_distribution<double> place(-reach_m, reach_m), turn(-pi, pi);
  Pose pose = at(place(random), place(random), place(random));
  pose.rotation = rotationFromRpy(turn(random), turn(random), turn(random));
  return pose;
}

TEST(Moments, Box_MatchesTextbook) {
  const ShapeMoments m = moments(box({0.1, 0.2, 0.3}));
  EXPECT_NEAR(m.volume_m3, 0.006, 1e-15);
  EXPECT_NEAR(m.inertia_m5(0, 0), 0.006 * (0.04 + 0.09) / 12.0, 1e-16);  // m (b² + c²) / 12
  EXPECT_NEAR(m.inertia_m5(1, 1), 0.006 * (0.01 + 0.09) / 12.0, 1e-16);
  EXPECT_NEAR(m.inertia_m5(2, 2), 0.006 * (0.01 + 0.04) / 12.0, 1e-16);
}

TEST(Moments, CapsuleWithoutLength_IsASphere) {
  const ShapeMoments capsule = moments(round(ShapeType::kCapsule, 0.02, 0.0));
  const ShapeMoments sphere = moments(round(ShapeType::kSphere, 0.02));
  EXPECT_NEAR(capsule.volume_m3, 4.0 / 3.0 * pi * 8e-6, 1e-18);                // 4/3 π r³
  EXPECT_NEAR(sphere.inertia_m5(0, 0), 0.4 * sphere.volume_m3 * 4e-4, 1e-20);  // 2/5 m r²
  EXPECT_TRUE(capsule.inertia_m5.isApprox(sphere.inertia_m5, 1e-12));
}

// Compares every type with a sum over a fine grid that uses only the sign of signedDistance(): an
// independent way to the same integral, accurate to about 1 %. The grid is off-centre, so that its
// errors do not add up by symmetry. Under a sanitizer it is coarser.
TEST(Moments, EveryShape_MatchesSumOverGrid) {
  for (const Shape& s : oneOfEach()) {
    constexpr int kCells = WHOLEHAND_SANITIZED ? 30 : 90;
    constexpr double kCoarse = 90.0 / kCells;
    constexpr double kHalf_m = 0.09, kCell_m = 2.0 * kHalf_m / kCells;
    double volume_m3 = 0.0;
    Vector3d first = Vector3d::Zero();
    Matrix3d second = Matrix3d::Zero();
    for (int i = 0; i < kCells * kCells * kCells; ++i) {
      const int layer = i / (kCells * kCells);
      const Vector3d cell(i % kCells, i / kCells % kCells, layer);
      const Vector3d p = s.in_body.translation_m + (cell + Vector3d(0.3, 0.6, 0.9)) * kCell_m -
                         Vector3d::Constant(kHalf_m);
      if (signedDistance(s, p) > 0.0) continue;
      const double v = kCell_m * kCell_m * kCell_m;
      volume_m3 += v;
      first += v * p;
      second += v * p * p.transpose();
    }
    const Vector3d center = first / volume_m3;
    second -= volume_m3 * center * center.transpose();
    const Matrix3d inertia = second.trace() * Matrix3d::Identity() - second;
    const ShapeMoments m = moments(s);
    const int type = static_cast<int>(s.type);
    EXPECT_NEAR(m.volume_m3 / volume_m3, 1.0, 0.01 * kCoarse) << "type " << type;
    EXPECT_LT((m.center_m - center).norm(), 2e-4 * kCoarse) << "type " << type;
    EXPECT_LT((m.inertia_m5 - inertia).norm() / inertia.norm(), 0.02 * kCoarse) << "type " << type;
  }
}

TEST(Moments, BoxAsAMesh_EqualsTheBox) {
  Shape exact = box({0.04, 0.06, 0.02}), mesh = boxMesh({0.04, 0.06, 0.02});
  exact.in_body = mesh.in_body = at(0.3, -0.2, 0.1);
  const ShapeMoments a = moments(exact), b = moments(mesh);
  EXPECT_NEAR(a.volume_m3, b.volume_m3, 1e-18);
  EXPECT_LT((a.center_m - b.center_m).norm(), 1e-15);
  EXPECT_LT((a.inertia_m5 - b.inertia_m5).norm(), 1e-12 * a.inertia_m5.norm());
}

TEST(SignedDistance, KnownPoints_AreExact) {
  const Shape cylinder = round(ShapeType::kCylinder, 0.03, 0.1);
  EXPECT_NEAR(signedDistance(cylinder, {0.07, 0.0, 0.08}), 0.05, 1e-15);  // 3-4-5 off the rim
  EXPECT_NEAR(signedDistance(cylinder, {0.0, 0.0, 0.045}), -0.005, 1e-15);
  const Shape cube = box({0.1, 0.1, 0.1});
  EXPECT_NEAR(signedDistance(cube, {0.08, 0.09, 0.0}), 0.05, 1e-15);  // 3-4-5 off the edge
  EXPECT_NEAR(signedDistance(cube, Vector3d::Zero()), -0.05, 1e-15);
  const Shape capsule = round(ShapeType::kCapsule, 0.01, 0.06);
  EXPECT_NEAR(signedDistance(capsule, {0.03, 0.0, 0.07}), 0.04, 1e-15);  // 3-4-5 off a cap
  EXPECT_NEAR(signedDistance(capsule, Vector3d::Zero()), -0.01, 1e-15);
}

// A distance never changes faster than the point moves, and a step along its gradient ends on the
// surface. The mesh is exact only inside; there the step must also end on the surface.
TEST(SignedDistance, AnyPoint_LeadsToTheSurface) {
  auto random = seededRandom(7);
  std::uniform_real_distribution<double> place(-0.08, 0.08);
  for (const Shape& s : oneOfEach()) {
    for (int i = 0; i < 300; ++i) {
      const Vector3d p(place(random), place(random), place(random));
      const Vector3d q = p + 1e-3 * Vector3d(place(random), place(random), place(random));
      const double d = signedDistance(s, p);
      EXPECT_LE(std::abs(d - signedDistance(s, q)), (p - q).norm() + 1e-12);
      if (s.type == ShapeType::kConvexMesh && d > 0.0) continue;
      Vector3d gradient;
      for (int k = 0; k < 3; ++k) {
        const Vector3d h = 1e-7 * Vector3d::Unit(k);
        gradient[k] = (signedDistance(s, p + h) - signedDistance(s, p - h)) / 2e-7;
      }
      if (std::abs(gradient.norm() - 1.0) > 1e-6) continue;  // on a ridge: no gradient
      EXPECT_NEAR(signedDistance(s, p - d * gradient), 0.0, 1e-8);
    }
  }
}

TEST(Separation, Spheres_AreApartByDistanceLessRadii) {
  const Shape a = round(ShapeType::kSphere, 0.03), b = round(ShapeType::kSphere, 0.02);
  EXPECT_NEAR(separation(a, at(0, 0, 0), b, at(0.06, 0.08, 0.0)), 0.05, 1e-12);
  EXPECT_NEAR(separation(a, at(0, 0, 0), b, at(0.03, 0.0, 0.0)), -0.02, 1e-12);
  EXPECT_NEAR(separation(a, at(0, 0, 0), b, at(0.0, 0.0, 0.0)), -0.05, 1e-12);  // concentric
}

TEST(Separation, SphereAgainstAnyShape_IsSignedDistanceLessRadius) {
  auto random = seededRandom(11);
  const Shape ball = round(ShapeType::kSphere, 0.01);
  for (const Shape& s : oneOfEach()) {
    for (int i = 0; i < 200; ++i) {
      const Pose body = randomPose(random, 0.1), ball_pose = randomPose(random, 0.1);
      const double d = signedDistance(s, body.inverse() * ball_pose.translation_m);
      if (s.type == ShapeType::kConvexMesh && d > 0.0) continue;  // a lower bound only
      EXPECT_NEAR(separation(s, body, ball, ball_pose), d - 0.01, 1e-6);
    }
  }
}

TEST(Separation, Boxes_MatchSlabs) {
  const Shape cube = box({0.1, 0.1, 0.1});
  EXPECT_NEAR(separation(cube, at(0, 0, 0), cube, at(0.13, 0.14, 0.0)), 0.05, 1e-10);  // 3-4-5
  EXPECT_NEAR(separation(cube, at(0, 0, 0), cube, at(0.08, 0.03, 0.0)), -0.02, 1e-8);
  EXPECT_NEAR(separation(cube, at(0, 0, 0), cube, at(0.1, 0.0, 0.0)), 0.0, 1e-8);
  EXPECT_NEAR(separation(cube, at(0, 0, 0), cube, at(0, 0, 0)), -0.1, 1e-8);  // the same place
  Pose turned = at(0.05 + 0.05 * std::sqrt(2.0) + 0.01, 0, 0);
  turned.rotation = rotationFromRpy(0.0, 0.0, pi / 4.0);  // an edge 10 mm off a face
  EXPECT_NEAR(separation(cube, at(0, 0, 0), cube, turned), 0.01, 1e-10);
}

// Aligned boxes are the hard case of the method (whole faces are equally far) and the usual one in
// scene files. Tests all offsets on a grid, some rotated by right angles, as boxes and as meshes.
TEST(Separation, AlignedBoxes_MatchSlabs) {
  const Vector3d size(0.04, 0.06, 0.02);
  const std::array<Shape, 2> kinds{box(size), boxMesh(size)};
  for (int i = 0; i < 5 * 5 * 5 * 4; ++i) {
    const int quarter = i / 125;
    const Vector3d offset =
        0.02 * Vector3d(i % 5, i / 5 % 5, i / 25 % 5) - Vector3d(0.04, 0.0, 0.01);
    Pose b = at(offset.x(), offset.y(), offset.z());
    b.rotation = rotationFromRpy(0.0, 0.0, pi / 2.0 * quarter);
    const Vector3d turned = (b.rotation * size).cwiseAbs();
    const Vector3d gap = offset.cwiseAbs() - (size + turned) / 2.0;
    const double expected = gap.cwiseMax(0.0).norm() + std::min(gap.maxCoeff(), 0.0);
    for (const Shape& s : kinds) {
      for (const Shape& t : kinds) {
        EXPECT_NEAR(separation(s, Pose{}, t, b), expected, 1e-8) << "offset " << offset.transpose();
      }
    }
  }
}

TEST(Separation, Capsules_MatchSegmentDistance) {
  const Shape a = round(ShapeType::kCapsule, 0.01, 0.1);
  const Shape b = capsuleShape({-0.05, 0.0, 0.0}, {0.05, 0.0, 0.0}, 0.02);
  EXPECT_NEAR(separation(a, at(0, 0, 0), b, at(0.0, 0.05, 0.0)), 0.02, 1e-12);     // crossing
  EXPECT_NEAR(separation(a, at(0, 0, 0), b, at(0.0, 0.0, 0.0)), -0.03, 1e-9);      // axes meet
  EXPECT_NEAR(separation(a, at(0, 0, 0), a, at(0.005, 0.0, 0.0)), -0.015, 1e-12);  // side by side
  EXPECT_NEAR(separation(a, at(0, 0, 0), a, at(0.0, 0.0, 0.15)), 0.03, 1e-12);     // end to end
  EXPECT_NEAR(separation(a, at(0, 0, 0), a, at(0.0, 0.0, 0.04)), -0.02, 1e-9);     // same line
}

TEST(Separation, CylinderOnATable_IsApartByItsHeightAboveIt) {
  const Shape table = box({0.4, 0.6, 0.04}), can = round(ShapeType::kCylinder, 0.025, 0.12);
  for (const double gap_m : {0.01, 1e-5, 0.0, -1e-5, -0.01}) {
    EXPECT_NEAR(separation(table, at(0, 0, -0.02), can, at(0.1, 0.07, 0.06 + gap_m)), gap_m, 1e-7);
  }
  Pose lying = at(0.0, 0.0, 0.02);  // rolls 5 mm deep: radius 25 mm, axis 20 mm above
  lying.rotation = rotationFromRpy(pi / 2.0, 0.0, 0.3);
  EXPECT_NEAR(separation(table, at(0, 0, -0.02), can, lying), -0.005, 1e-7);
}

TEST(Separation, MeshBox_EqualsBoxAgainstAnyShape) {
  auto random = seededRandom(3);
  const Shape exact = box({0.04, 0.06, 0.02}), mesh = boxMesh({0.04, 0.06, 0.02});
  for (const Shape& s : oneOfEach()) {
    for (int i = 0; i < 100; ++i) {
      const Pose a = randomPose(random, 0.05), b = randomPose(random, 0.05);
      EXPECT_NEAR(separation(exact, a, s, b), separation(mesh, a, s, b), 1e-6);
    }
  }
}

/// Extent of a shape from its own centre along a unit direction of its body's frame [m].
double reach(const Shape& s, const Vector3d& direction) {
  const Vector3d n = (s.in_body.rotation.transpose() * direction).cwiseAbs();
  switch (s.type) {
    case ShapeType::kSphere:
      return s.radius_m;
    case ShapeType::kCapsule:
      return s.radius_m + s.length_m / 2.0 * n.z();
    case ShapeType::kCylinder:
      return s.radius_m * n.head<2>().norm() + s.length_m / 2.0 * n.z();
    case ShapeType::kBox:
      return s.half_extents_m.dot(n);
    case ShapeType::kConvexMesh:
      return Vector3d(0.02, 0.03, 0.01).dot(n);  // boxMesh() of oneOfEach()
  }
  return 0.0;
}

/// Width of the gap between two shapes along a direction; negative where they overlap.
double gapAlong(const Shape& s, const Pose& a, const Shape& t, const Pose& b, const Vector3d& n) {
  const Vector3d between = b * t.in_body.translation_m - a * s.in_body.translation_m;
  return n.dot(between) - reach(s, a.rotation.transpose() * n) -
         reach(t, b.rotation.transpose() * n);
}

/// Directions in which a deep overlap may be smallest: the axes of both shapes and the cross
/// products of two of them.
std::vector<Vector3d> likelyDirections(const Shape& s, const Pose& a, const Shape& t,
                                       const Pose& b) {
  const Eigen::Matrix3d of_s = a.rotation * s.in_body.rotation;
  const Eigen::Matrix3d of_t = b.rotation * t.in_body.rotation;
  std::vector<Vector3d> all;
  for (int i = 0; i < 3; ++i) {
    all.push_back(of_s.col(i));
    all.push_back(of_t.col(i));
    for (int k = 0; k < 3; ++k) all.push_back(of_s.col(i).cross(of_t.col(k)).normalized());
  }
  for (std::size_t i = 0, n = all.size(); i < n; ++i) all.push_back(-all[i]);
  return all;
}

// The separation of convex shapes is the largest gap over all directions. Closed-form extents, many
// directions and a climb from each of them find it without the code under test.
TEST(Separation, RandomPairs_GiveTheLargestGapOverDirections) {
  auto random = seededRandom(5);
  std::normal_distribution<double> any;
  const auto direction = [&] { return Vector3d(any(random), any(random), any(random)); };
  int overlapping = 0;
  const int pairs = cases(3);
  std::size_t kinds = 0;
  for (const Shape& s : oneOfEach()) {
    for (const Shape& t : oneOfEach()) {
      if (leftOutUnderASanitizer(kinds++)) continue;
      for (int i = 0; i < pairs; ++i) {
        const Pose a = randomPose(random, 0.03), b = randomPose(random, 0.03);
        const double d = separation(s, a, t, b);
        overlapping += d < 0.0 ? 1 : 0;
        double largest = -1.0;
        // A deep overlap has several local maxima.
        std::vector<Vector3d> starts = likelyDirections(s, a, t, b);
        for (int start = 0; start < 10; ++start) starts.push_back(direction().normalized());
        for (Vector3d best : starts) {
          double climbed = gapAlong(s, a, t, b, best);
          for (int k = 0; k < 1000; ++k) {
            const Vector3d n = (best + 0.5 * std::pow(0.989, k) * direction()).normalized();
            const double gap = gapAlong(s, a, t, b, n);
            if (gap > climbed) climbed = gap, best = n;
          }
          largest = std::max(largest, climbed);
        }
        EXPECT_LE(largest, d + 1e-6);  // no direction separates them farther
        EXPECT_NEAR(largest, d, 2e-5);
        EXPECT_NEAR(d, separation(t, b, s, a), 1e-6);
      }
    }
  }
  if (kStatisticsMeaningful) {
    EXPECT_GT(overlapping, 10 * pairs);
  }
}

TEST(CapsuleShape, RandomEnds_AreAtTheGivenPoints) {
  const std::array<Vector3d, 3> ends{Vector3d(0.0, 0.0, -0.05), Vector3d(0.03, 0.04, 0.0),
                                     Vector3d(0.0, 0.0, 0.0)};
  for (const Vector3d& end : ends) {
    const Shape s = capsuleShape(Vector3d::Zero(), end, 0.01);
    EXPECT_NEAR(s.length_m, end.norm(), 1e-15);
    EXPECT_NEAR(signedDistance(s, end), -0.01, 1e-12);
    EXPECT_NEAR(signedDistance(s, Vector3d::Zero()), -0.01, 1e-12);
    EXPECT_NEAR(signedDistance(s, end * 1.5), end.norm() * 0.5 - 0.01, 1e-12);
  }
}

}  // namespace
}  // namespace wholehand::test
