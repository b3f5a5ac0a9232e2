#include "files/mesh/convex_hull.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/scene/scene_file.hpp"
#include "files/scene_text.hpp"
#include "files/solid_samples.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/folder.hpp"
#include "support/seed.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using std::numbers::pi;

using Triangles = std::vector<Vector3i>;

/// A prism of 20 mm height over a polygon in the plane z = 0, with its caps given as triangles.
MeshSurface cappedPrism(const std::vector<Eigen::Vector2d>& polygon_m, const Triangles& cap) {
  MeshSurface mesh;
  const int n = static_cast<int>(polygon_m.size());
  for (const double z_m : {0.0, 0.02}) {
    for (const Eigen::Vector2d& p : polygon_m) mesh.points.emplace_back(p.x(), p.y(), z_m);
  }
  for (const Vector3i& t : cap) {
    mesh.triangles.emplace_back(t[0], t[2], t[1]);
    mesh.triangles.emplace_back(t[0] + n, t[1] + n, t[2] + n);
  }
  for (int i = 0; i < n; ++i) addQuad(mesh, i, (i + 1) % n, (i + 1) % n + n, i + n);
  return mesh;
}

/// A cube of 20 mm with `cells` x `cells` squares on each face. Squares do not share corners, as in
/// STL.
MeshSurface dividedCube(int cells) {
  MeshSurface mesh;
  const double step_m = 0.02 / cells;
  for (int face = 0; face < 6; ++face) {
    const int u = (face / 2 + 1) % 3, v = (face / 2 + 2) % 3;
    for (int i = 0; i < cells; ++i) {
      for (int j = 0; j < cells; ++j) {
        const int first = static_cast<int>(mesh.points.size());
        for (const auto& [a, b] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
          Vector3d p;
          p[face / 2] = face % 2 == 0 ? 0.0 : 0.02;
          p[u] = (i + a) * step_m;
          p[v] = (j + b) * step_m;
          mesh.points.push_back(p);
        }
        const int k = face % 2 == 0 ? -1 : 1;  // wound outward
        addQuad(mesh, first, first + (k > 0 ? 1 : 3), first + 2, first + (k > 0 ? 3 : 1));
      }
    }
  }
  return mesh;
}

/// The collider of a valid mesh.
MeshCollider colliderOf(const MeshSurface& mesh) {
  return orThrow(meshCollider({mesh, {}, {}}));
}

std::string noticeOf(const MeshCollider& collider) {
  return format(collider.notices);
}

std::string hullProblemOf(const MeshSurface& mesh) {
  const Expected<MeshCollider> collider = meshCollider({mesh, {}, {}});
  return collider ? "" : format(collider.errors());
}

TEST(MeshCollider, CubeWithADent_BecomesTheCube) {
  // The top is a pyramid down to the centre, which removes a third of its base times its height.
  MeshSurface cube =
      cappedPrism({{0, 0}, {0.02, 0}, {0.02, 0.02}, {0, 0.02}}, {{0, 1, 2}, {0, 2, 3}});
  cube.points.emplace_back(0.01, 0.01, 0.01);
  std::erase_if(cube.triangles, [](const Vector3i& t) { return t.minCoeff() >= 4; });
  for (int i = 0; i < 4; ++i) cube.triangles.emplace_back(4 + i, 4 + (i + 1) % 4, 8);
  const MeshCollider collider = colliderOf(cube);
  const ShapeMoments m = moments(collider.shapes[0]);
  EXPECT_NEAR(m.volume_m3, 8e-6, 1e-18);
  EXPECT_LT((m.center_m - Vector3d::Constant(0.01)).norm(), 1e-15);
  EXPECT_EQ(collider.shapes[0].points_m.size(), 8U);
  // 8 / (8 - 4/3) = 1.2.
  EXPECT_TRUE(contains(noticeOf(collider), "20 % larger"));
  EXPECT_TRUE(contains(noticeOf(collider), "is not convex"));
}

TEST(MeshCollider, LShape_LosesItsInnerCorner) {
  const double w = 0.02;
  const MeshSurface bar =
      cappedPrism({{0, 0}, {4 * w, 0}, {4 * w, w}, {w, w}, {w, 4 * w}, {0, 4 * w}},
                  {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}});
  const MeshCollider collider = colliderOf(bar);
  // 4 x 4 less the triangle beyond the two ends: 16 - 9/2, compared with the 7 of the L.
  EXPECT_NEAR(moments(collider.shapes[0]).volume_m3, 11.5 * w * w * w, 1e-17);
  EXPECT_EQ(collider.shapes[0].points_m.size(), 10U);
  EXPECT_TRUE(contains(noticeOf(collider), "64.3 % larger"));
}

TEST(MeshCollider, Ring_IsFilled) {
  constexpr int kAround = 24, kAcross = 16;
  constexpr double kRadius_m = 0.04, kTube_m = 0.01;
  const MeshSurface ring = torus(kRadius_m, kTube_m, kAround, kAcross);
  const MeshCollider collider = colliderOf(ring);
  // At one height the hull's section is a polygon of the outer radius there: its area is `slice`
  // r².
  const double slice = 0.5 * kAround * std::sin(2.0 * pi / kAround);
  double hull_m3 = 0.0;
  for (int j = -kAcross / 4; j < kAcross / 4; ++j) {
    const double v = 2.0 * pi * j / kAcross, w = 2.0 * pi * (j + 1) / kAcross;
    const double r = kRadius_m + kTube_m * std::cos(v), s = kRadius_m + kTube_m * std::cos(w);
    hull_m3 += slice * kTube_m * (std::sin(w) - std::sin(v)) * (r * r + r * s + s * s) / 3.0;
  }
  // For the ring, outer radius squared less inner radius squared is 4 R a cos v.
  const double section_m2 = 0.5 * kAcross * std::sin(2.0 * pi / kAcross) * kTube_m * kTube_m;
  const double ring_m3 = 2.0 * slice * kRadius_m * section_m2;
  EXPECT_NEAR(moments(collider.shapes[0]).volume_m3, hull_m3, 1e-12 * hull_m3);
  EXPECT_LT(signedDistance(collider.shapes[0], Vector3d::Zero()),
            -0.9 * kTube_m);  // the hole is filled
  const std::string larger = fmt::format("{:.3g} % larger", 100.0 * (hull_m3 / ring_m3 - 1.0));
  EXPECT_TRUE(contains(noticeOf(collider), larger)) << larger << noticeOf(collider);
}

TEST(MeshCollider, ConvexMesh_IsUnchanged) {
  const MeshSurface cube = dividedCube(4);
  const MeshCollider collider = colliderOf(cube);
  const Shape shape = orThrow(convexMesh(cube.points, cube.triangles));
  EXPECT_TRUE(collider.notices.empty()) << noticeOf(collider);
  EXPECT_EQ(collider.shapes[0].points_m, shape.points_m);
  EXPECT_EQ(collider.shapes[0].triangles, shape.triangles);
}

TEST(MeshCollider, FineMesh_KeepsTheCornersOfItsHull) {
  const MeshCollider cube = colliderOf(dividedCube(40));  // 19,200 triangles
  EXPECT_EQ(cube.shapes[0].points_m.size(), 8U);
  EXPECT_EQ(cube.shapes[0].triangles.size(), 12U);
  EXPECT_NEAR(moments(cube.shapes[0]).volume_m3, 8e-6, 1e-18);
  EXPECT_TRUE(contains(noticeOf(cube), "has 19200 triangles"));
  EXPECT_TRUE(contains(noticeOf(cube), " 0 % larger"));
}

TEST(MeshCollider, HullOfManyCorners_IsReducedAndReportsByHowMuch) {
  constexpr double kRadius_m = 0.05;
  MeshSurface ball;  // 200 x 100 corners on the sphere
  constexpr int kAround = 200, kRings = 99;
  ball.points.emplace_back(0.0, 0.0, kRadius_m);
  for (int j = 1; j <= kRings; ++j) {
    for (int i = 0; i < kAround; ++i) {
      const double u = 2.0 * pi * i / kAround, v = pi * j / (kRings + 1);
      ball.points.push_back(
          kRadius_m * Vector3d(std::sin(v) * std::cos(u), std::sin(v) * std::sin(u), std::cos(v)));
    }
  }
  ball.points.emplace_back(0.0, 0.0, -kRadius_m);
  const int last = static_cast<int>(ball.points.size()) - 1;
  for (int i = 0; i < kAround; ++i) {
    const int next = (i + 1) % kAround;
    ball.triangles.emplace_back(0, 1 + i, 1 + next);
    for (int j = 0; j + 1 < kRings; ++j) {
      const int row = 1 + j * kAround, below = row + kAround;
      addQuad(ball, row + i, below + i, below + next, row + next);
    }
    const int row = 1 + (kRings - 1) * kAround;
    ball.triangles.emplace_back(row + i, last, row + next);
  }
  const MeshCollider collider = colliderOf(ball);
  EXPECT_LE(collider.shapes[0].points_m.size(), std::size_t{kMaxMeshPoints});
  // n corners spread evenly over a sphere leave caps of about 4 pi r² / n each: a polyhedron of
  // them loses about 2 pi / (sqrt(3) n) of the radius, and three times that in volume.
  const double sphere_m3 = 4.0 / 3.0 * pi * std::pow(kRadius_m, 3);
  const double lost = 1.0 - moments(collider.shapes[0]).volume_m3 / sphere_m3;
  EXPECT_GT(lost, 0.0);
  EXPECT_LT(lost, 3.0 * 2.0 * 2.0 * pi / (std::sqrt(3.0) * kMaxMeshPoints));
  const std::string notice = noticeOf(collider);
  EXPECT_TRUE(contains(notice, "has 39600 triangles"));
  EXPECT_TRUE(contains(notice, "smaller in volume"));
  double outside_m = 0.0;
  for (const Vector3d& p : ball.points) {
    outside_m = std::max(outside_m, signedDistance(collider.shapes[0], p));
  }
  EXPECT_TRUE(contains(notice, fmt::format("{:.2g} mm outside of at most", 1e3 * outside_m)));
}

TEST(MeshCollider, OpenOrInconsistentSurface_HasAHullAndNoVolume) {
  MeshSurface open = dividedCube(2), mixed = torus(0.04, 0.01, 12, 8);
  std::erase_if(open.triangles, [&](const Vector3i& t) {
    return open.points[t[0]].z() + open.points[t[1]].z() + open.points[t[2]].z() > 0.0599;
  });
  std::swap(mixed.triangles[5][0], mixed.triangles[5][1]);
  const MeshCollider cube = colliderOf(open);
  EXPECT_NEAR(moments(cube.shapes[0]).volume_m3, 8e-6, 1e-18);
  EXPECT_TRUE(contains(noticeOf(cube), "is not watertight"));
  EXPECT_TRUE(contains(noticeOf(cube), "of 8 cm3"));
  EXPECT_TRUE(contains(noticeOf(colliderOf(mixed)), "unknown"));
}

TEST(MeshCollider, DegenerateMeshes_AreRefusedByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  MeshSurface flat = torus(0.04, 0.01, 24, 16), line = flat, speck = flat, lost = flat, far = flat;
  for (Vector3d& p : flat.points) p.z() = 0.01;
  for (Vector3d& p : line.points) p = p.x() * Vector3d(1.0, 2.0, 3.0);
  for (Vector3d& p : speck.points) p.setConstant(0.1);
  lost.points[7].y() = nan;
  for (Vector3d& p : far.points) p *= 1000.0;
  MeshSurface none = flat, wrong = flat;
  none.triangles.clear();
  wrong.triangles[0][0] = static_cast<int>(wrong.points.size());
  const MeshSurface two{{Vector3d::Zero(), Vector3d::Ones(), Vector3d::UnitX()}, {{0, 1, 2}}};
  const struct {
    const MeshSurface& mesh;
    const char* problem;
  } cases[] = {{flat, "is flat"},       {line, "is flat"},        {speck, "is flat"},
               {lost, "is not finite"}, {far, "m across"},        {none, "has no faces"},
               {two, "is flat"},        {wrong, "does not exist"}};
  for (const auto& c : cases) {
    EXPECT_TRUE(contains(hullProblemOf(c.mesh), c.problem))
        << c.problem << ": " << hullProblemOf(c.mesh);
  }
}

TEST(MeshCollider, RandomPoints_LieInTheirHull) {
  auto random = seededRandom(273);
  std::normal_distribution<double> normal;
  std::uniform_int_distribution<int> pick(0, 99);
  for (int round = 0; round < 200; ++round) {
    // A cloud with repeated, nearly repeated and coplanar points, as floats as in a file.
    MeshSurface cloud;
    const double near_m = std::pow(10.0, -3.0 - 6.0 * (round % 10) / 9.0);
    for (int i = 0; i < 100; ++i) {
      Vector3d p(0.03 * normal(random), 0.02 * normal(random), 0.01 * normal(random));
      if (i % 4 == 1) p = cloud.points[pick(random) % i];
      if (i % 4 == 2) p = cloud.points[pick(random) % i] + near_m * p.normalized();
      if (i % 4 == 3 && round % 2 == 0) p.x() = 0.08;
      cloud.points.push_back(p.cast<float>().cast<double>());
    }
    for (int i = 0; i + 2 < 100; ++i) cloud.triangles.emplace_back(i, i + 1, i + 2);
    const MeshCollider collider = colliderOf(cloud);
    for (const Vector3d& p : cloud.points) {
      EXPECT_LT(signedDistance(collider.shapes[0], p), 1e-6) << round;
    }
  }
}

TEST(MeshCollider, LargestMesh_TakesALimitedTime) {
  const MeshSurface ring = torus(0.04, 0.01, 500, 200);  // kMaxMeshTriangles
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(hullProblemOf(ring), "");
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  std::printf("figure: hull of %zu triangles in %.2f s\n", ring.triangles.size(), took.count());
  const std::string more = hullProblemOf(torus(0.04, 0.01, 501, 200));
  EXPECT_TRUE(contains(more, "has 200400 triangles"));
}

TEST(MeshCollider, NoticeOfAScene_NamesFileLineKeyAndRemedy) {
  const Folder folder;
  folder.write("dent.obj",
               "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0.1 0.1 0.1\nf 1 3 2\nf 1 2 4\n"
               "f 1 4 3\nf 2 3 5\nf 3 4 5\nf 4 2 5\n");
  folder.write("dent.urdf", R"(<robot name="r"><link name="a"><collision><geometry>
<mesh filename="dent.obj" scale="0.1 0.1 0.1"/></geometry></collision></link></robot>)");
  const std::string path = folder.write(
      "scene.toml", kSceneHead + fileBody("mesh", "mesh", "dent.obj") + "mass_kg = 1.0\n" +
                        fileBody("urdf", "urdf", "dent.urdf", 2.0) + "mass_kg = 0.1\n");
  const SceneModel scene = orThrow(loadSceneFile(path));
  ASSERT_EQ(scene.notices.size(), 2U);
  const std::string mesh = format(scene.notices[0]), urdf = format(scene.notices[1]);
  EXPECT_EQ(mesh.find(path + ":8: bodies[mesh].file: the mesh "), 0U) << mesh;
  EXPECT_EQ(
      urdf.find(folder.file("dent.urdf") + ":2: link[a].collision[0].mesh.filename = dent.obj"), 0U)
      << urdf;
  for (const std::string& notice : {mesh, urdf}) {
    EXPECT_TRUE(contains(notice, "dent.obj is not convex"));
    // The dent leaves the tetrahedron under it, by the determinant of its three edges: (1 - 0.3) /
    // 6 is missing, 0.3 / 6 remains.
    EXPECT_TRUE(contains(notice, "233 % larger"));
    EXPECT_TRUE(contains(
        notice, "; the hand cannot reach into a hollow of it; where it shall, give convex"));
  }
}

}  // namespace
}  // namespace wholehand::test
