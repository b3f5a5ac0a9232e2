// Convex pieces of solids with a known volume.
#include "files/mesh/convex_pieces.hpp"

#include "files/mesh/convex_hull.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/solid.hpp"
#include "files/solid_samples.hpp"
#include "support/contains.hpp"
#include "support/tolerance.hpp"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using std::numbers::pi;

ClosedSurface solidOf(const MeshSurface& mesh) {
  auto solid = closedSurface(mesh.points, mesh.triangles);
  EXPECT_TRUE(solid) << (solid ? "" : format(solid.errors()));
  return std::move(*solid);
}

ConvexPieces piecesOf(const MeshSurface& mesh, double concavity_m, int most_pieces = 16,
                      int most_vertices = 64) {
  auto pieces = convexPieces(solidOf(mesh), {most_pieces, concavity_m, most_vertices});
  EXPECT_TRUE(pieces) << (pieces ? "" : format(pieces.errors()));
  return std::move(*pieces);
}

std::string solidProblemOf(const MeshSurface& mesh) {
  const auto solid = closedSurface(mesh.points, mesh.triangles);
  EXPECT_FALSE(solid);
  if (solid) return "";
  EXPECT_FALSE(solid.errors().front().remedy.empty());
  return solid.errors().front().problem;
}

MeshSurface cube(double edge_m) {
  return prism({{0, 0}, {edge_m, 0}, {edge_m, edge_m}, {0, edge_m}}, edge_m);
}

/// Checks that a scene can take every piece as it is: convexMesh() checks every vertex against
/// every face and every edge for its two faces. The faces are wound outward, so the volume is
/// positive.
void expectConvex(const ConvexPieces& result, std::size_t most_vertices) {
  for (const MeshSurface& piece : result.pieces) {
    const auto shape = convexMesh(piece.points, piece.triangles);
    EXPECT_TRUE(shape) << (shape ? "" : format(shape.errors()));
    EXPECT_GT(signedVolume(piece), 0.0);
    EXPECT_LE(piece.points.size(), most_vertices);
    const Vector3d middle = [&] {
      Vector3d sum = Vector3d::Zero();
      for (const Vector3d& p : piece.points) sum += p;
      return Vector3d(sum / static_cast<double>(piece.points.size()));
    }();
    for (const Vector3i& t : piece.triangles) {
      const Vector3d& a = piece.points[t[0]];
      const Vector3d normal = (piece.points[t[1]] - a).cross(piece.points[t[2]] - a);
      EXPECT_GT(normal.dot(a - middle), 0.0);
    }
  }
}

TEST(ConvexPieces, LShape_GivesTwoBoxes) {
  const ConvexPieces l = piecesOf(lShape(), 1e-3);
  ASSERT_EQ(l.pieces.size(), 2U);
  expectConvex(l, 8);
  // 60 x 20 x 20 mm and 20 x 40 x 20 mm; floats have 24 bits.
  EXPECT_NEAR(l.pieces_m3, 40e-6, 40e-6 * 1e-6);
  EXPECT_LT(l.overlap_m3, 40e-6 * 1e-6);
  EXPECT_LT(l.beyond_m, 1e-8);
  EXPECT_LT(l.missing_m, 1e-8);
}

TEST(ConvexPieces, RotatedLShape_GivesTwoBoxes) {
  MeshSurface turned = lShape();
  const Eigen::Quaterniond q = Eigen::Quaterniond(0.4, -0.3, 0.7, 0.5).normalized();
  for (Vector3d& p : turned.points) p = q * p + Vector3d(0.3, -0.2, 0.1);
  const ConvexPieces l = piecesOf(turned, 1e-3);
  ASSERT_EQ(l.pieces.size(), 2U);
  expectConvex(l, 64);
  EXPECT_NEAR(l.pieces_m3, 40e-6, 40e-6 * 1e-5);
}

TEST(ConvexPieces, ConvexMesh_StaysOnePiece) {
  const ConvexPieces box = piecesOf(cube(0.1), 1e-4);
  ASSERT_EQ(box.pieces.size(), 1U);
  EXPECT_EQ(box.pieces[0].points.size(), 8U);
  EXPECT_NEAR(box.pieces_m3, 1e-3, 1e-9);
}

TEST(ConvexPieces, Torus_KeepsItsVolumeAndHole) {
  constexpr double kRing_m = 0.04, kTube_m = 0.012;
  const MeshSurface mesh = torus(kRing_m, kTube_m, 32, 16);
  const ConvexPieces ring = piecesOf(mesh, 1.5e-3);
  expectConvex(ring, 64);
  EXPECT_LE(ring.pieces.size(), 16U);
  // The volume of the torus is 2 pi^2 R r^2. The mesh of 16-gons has 2.6 % less, 8 sin(2 pi / 16) /
  // pi of a circle's area; a piece bulges by R + r less the chord.
  const double torus_m3 = 2.0 * pi * pi * kRing_m * kTube_m * kTube_m;
  EXPECT_NEAR(ring.pieces_m3, torus_m3, 0.05 * torus_m3);
  EXPECT_LE(ring.beyond_m, 1.5e-3);
  // The hole is open: no piece is nearer to the axis than the mesh, less the concavity.
  double nearest = std::numeric_limits<double>::infinity();
  for (const MeshSurface& piece : ring.pieces) {
    nearest = std::min(nearest, SurfaceDistance(piece).to(Vector3d::Zero()));
  }
  EXPECT_GT(nearest, kRing_m - kTube_m - 1.5e-3);
}

TEST(ConvexPieces, Cup_StaysOpen) {
  const MeshSurface mesh = cup(24);
  const ConvexPieces cup = piecesOf(mesh, 1.4e-3);
  expectConvex(cup, 64);
  EXPECT_LT(cup.missing_m,
            1e-6);  // no corner of a cut is lost: all hulls have less than 64 vertices
  const double volume_m3 = solidOf(mesh).volume_m3;
  EXPECT_LT(std::abs(cup.pieces_m3 - cup.overlap_m3 - volume_m3), 0.2 * volume_m3);
  for (const MeshSurface& piece : cup.pieces) {
    const SurfaceDistance distance(piece);
    for (const double z : {0.01, 0.04, 0.085}) {
      EXPECT_LT(distance.windings({0.0, 0.0, z}), 0.5) << z;
      if (z > 0.03) {
        EXPECT_GT(distance.to({0.0, 0.0, z}), 0.025) << z;
      }
    }
  }
}

TEST(ConvexPieces, LargerConcavityAndFewerPieces_AreRespected) {
  const MeshSurface mesh = torus(0.04, 0.012, 16, 8);
  EXPECT_EQ(piecesOf(mesh, 1.0).pieces.size(), 1U);
  EXPECT_EQ(piecesOf(mesh, 1e-3, 1).pieces.size(), 1U);
  const ConvexPieces four = piecesOf(mesh, 1e-4, 4, 12);
  EXPECT_EQ(four.pieces.size(), 4U);
  expectConvex(four, 12);
  EXPECT_GT(four.beyond_m, 1e-4);  // reported, not hidden
}

TEST(ConvexPieces, SameInput_GivesTheSameBits) {
  const MeshSurface mesh = kReducedCounts ? lShape() : cup(12);
  const ConvexPieces a = piecesOf(mesh, 2e-3), b = piecesOf(mesh, 2e-3);
  ASSERT_EQ(a.pieces.size(), b.pieces.size());
  for (std::size_t i = 0; i < a.pieces.size(); ++i) {
    EXPECT_EQ(a.pieces[i].points, b.pieces[i].points);
    EXPECT_EQ(a.pieces[i].triangles, b.pieces[i].triangles);
  }
}

TEST(ConvexPieces, OverlappingParts_AreDetected) {
  MeshSurface two = cube(0.1);
  const MeshSurface other = cube(0.1);
  for (const Vector3d& p : other.points) two.points.push_back(p + Vector3d(0.05, 0.03, 0.02));
  for (const Vector3i& t : other.triangles) two.triangles.push_back(t.array() + 8);
  EXPECT_GT(piecesOf(two, 1e-3).twice_share, 0.0);
  EXPECT_EQ(piecesOf(cube(0.1), 1e-3).twice_share, 0.0);
}

TEST(ClosedSurface, InwardMesh_IsTurned) {
  MeshSurface inward = cube(0.1);
  for (Vector3i& t : inward.triangles) std::swap(t[1], t[2]);
  const ClosedSurface solid = solidOf(inward);
  EXPECT_EQ(solid.turned, TurnedShells::kAll);
  EXPECT_NEAR(signedVolume(solid.surface), 1e-3, 1e-12);
  EXPECT_EQ(solidOf(cube(0.1)).turned, TurnedShells::kNone);
}

/// A cube with its lower corner at (x, x, x), wound inward if requested.
MeshSurface cubeAt(double x_m, double edge_m, bool inward) {
  MeshSurface mesh = cube(edge_m);
  for (Vector3d& p : mesh.points) p += Vector3d::Constant(x_m);
  if (inward) {
    for (Vector3i& t : mesh.triangles) std::swap(t[1], t[2]);
  }
  return mesh;
}

void append(MeshSurface& mesh, const MeshSurface& other) {
  const int first = static_cast<int>(mesh.points.size());
  mesh.points.insert(mesh.points.end(), other.points.begin(), other.points.end());
  for (const Vector3i& t : other.triangles) mesh.triangles.push_back(t.array() + first);
}

// A mirrored part: the mesh's signed volume is that of the larger part less that of the smaller
// one.
TEST(ClosedSurface, InwardShellBesideAnother_IsTurned) {
  for (const double x_m : {0.2, 0.1, 0.05}) {  // apart, touching at a corner, overlapping
    for (const bool smaller : {false, true}) {
      MeshSurface mesh = cubeAt(0.0, 0.1, !smaller);
      append(mesh, cubeAt(x_m, 0.06, smaller));
      const ClosedSurface solid = solidOf(mesh);
      EXPECT_EQ(solid.turned, TurnedShells::kSome);
      EXPECT_NEAR(solid.volume_m3, 1e-3 + 0.216e-3, 1e-12) << x_m;
    }
  }
}

// The shells share a face's corners: each edge of the face belongs to four triangles.
TEST(ClosedSurface, InwardShellOnAnothersFace_IsTurned) {
  MeshSurface mesh = cube(0.1), other = cube(0.1);
  for (Vector3d& p : other.points) p.z() += 0.1;
  MeshSurface outward = mesh;
  append(outward, other);
  EXPECT_NEAR(solidOf(outward).volume_m3, 2e-3, 1e-12);
  EXPECT_EQ(solidOf(outward).turned, TurnedShells::kNone);
  for (Vector3i& t : other.triangles) std::swap(t[1], t[2]);
  append(mesh, other);
  EXPECT_NEAR(solidOf(mesh).volume_m3, 2e-3, 1e-12);
  EXPECT_EQ(solidOf(mesh).turned, TurnedShells::kSome);
}

TEST(ClosedSurface, HollowInsideASolid_StaysInward) {
  MeshSurface hollow = cubeAt(0.0, 0.1, false);
  append(hollow, cubeAt(0.02, 0.05, true));
  constexpr double kHollow_m3 = 1e-3 - 0.125e-3;
  EXPECT_EQ(solidOf(hollow).turned, TurnedShells::kNone);
  EXPECT_NEAR(solidOf(hollow).volume_m3, kHollow_m3, 1e-12);
  append(hollow, cubeAt(0.03, 0.01, false));  // a core in the hollow
  EXPECT_NEAR(solidOf(hollow).volume_m3, kHollow_m3 + 1e-6, 1e-12);
  // The hollow of an inward part is turned with it.
  MeshSurface inward = cubeAt(0.0, 0.1, true);
  append(inward, cubeAt(0.02, 0.05, false));
  EXPECT_EQ(solidOf(inward).turned, TurnedShells::kAll);
  EXPECT_NEAR(solidOf(inward).volume_m3, kHollow_m3, 1e-12);
  append(inward, cubeAt(0.2, 0.15, false));
  EXPECT_EQ(solidOf(inward).turned, TurnedShells::kSome);
  EXPECT_NEAR(solidOf(inward).volume_m3, kHollow_m3 + 3.375e-3, 1e-12);
}

TEST(ClosedSurface, FaultyMeshes_AreRefused) {
  MeshSurface open = cube(0.1), both = cube(0.1), nan = cube(0.1), flat = cube(0.1),
              many = cube(0.1);
  open.triangles.pop_back();
  EXPECT_TRUE(contains(solidProblemOf(open), "not closed"));
  std::swap(both.triangles[0][1], both.triangles[0][2]);
  EXPECT_TRUE(contains(solidProblemOf(both), "wound both ways"));
  nan.points[3].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(contains(solidProblemOf(nan), "not finite"));
  for (Vector3d& p : flat.points) p.z() *= 1e-7;
  EXPECT_FALSE(solidProblemOf(flat).empty());
  many.triangles.resize(kMaxSolidTriangles + 1, many.triangles[0]);
  EXPECT_TRUE(contains(solidProblemOf(many), "20001 triangles"));
  EXPECT_TRUE(contains(solidProblemOf(cube(1e-5)), "across"));
  EXPECT_TRUE(contains(solidProblemOf({}), "empty"));
}

TEST(SolidCut, BothSidesOfACut_AddUpToTheWhole) {
  const ClosedSurface solid = solidOf(torus(0.04, 0.012, 24, 12));
  std::vector<Facet> facets;
  for (const Vector3i& t : solid.surface.triangles) {
    const auto& p = solid.surface.points;
    facets.push_back({{p[t[0]], p[t[1]], p[t[2]]}, false});
  }
  // Cuts through two disks, along a row of vertices, and oblique ones: a cap may have two parts.
  std::vector<std::vector<Facet>> parts{facets};
  for (const Vector3d& n : {Vector3d(1, 0, 0), Vector3d(0, 0, 1), Vector3d(0.3, 0.8, 0.52)}) {
    const CutPlane plane{n.normalized(), n.x() == 0.3 ? 0.004 : 0.0};
    std::vector<std::vector<Facet>> next;
    for (const auto& part : parts) {
      next.push_back(cutBehind(part, plane, 1e-10));
      next.push_back(cutBehind(part, plane.turned(), 1e-10));
    }
    parts = std::move(next);
    double sum_m3 = 0.0;
    for (const auto& part : parts) sum_m3 += volumeOf(part);
    EXPECT_NEAR(sum_m3, solid.volume_m3, 1e-9 * solid.volume_m3);
  }
  // The first two cuts are planes of symmetry: a quarter each.
  const auto half = cutBehind(facets, {Vector3d::UnitX(), 0.0}, 1e-10);
  EXPECT_NEAR(volumeOf(half), solid.volume_m3 / 2.0, 1e-9 * solid.volume_m3);
  EXPECT_NEAR(volumeOf(cutBehind(half, {Vector3d::UnitZ(), 0.0}, 1e-10)), solid.volume_m3 / 4.0,
              1e-9 * solid.volume_m3);
}

TEST(SurfaceDistance, CubesSurface_HasTheDistanceOfABox) {
  const MeshSurface box = cube(1.0);
  const SurfaceDistance distance(box);
  EXPECT_NEAR(distance.to({0.5, 0.5, 0.7}), 0.3, 1e-12);                // inside: the nearest face
  EXPECT_NEAR(distance.to({2.0, 0.5, 0.5}), 1.0, 1e-12);                // above a face
  EXPECT_NEAR(distance.to({2.0, 2.0, 0.5}), std::sqrt(2.0), 1e-12);     // beside an edge
  EXPECT_NEAR(distance.to({-1.0, -1.0, -1.0}), std::sqrt(3.0), 1e-12);  // beside a corner
  EXPECT_NEAR(distance.windings({0.2, 0.6, 0.9}), 1.0, 1e-12);
  EXPECT_NEAR(distance.windings({0.2, 0.6, 1.1}), 0.0, 1e-12);
}

TEST(ReducedHull, HullOfABall_KeepsTheBound) {
  std::vector<Vector3d> points;
  for (int i = 0; i < 500; ++i) {  // a spiral from pole to pole
    const double z = 1.0 - 2.0 * (i + 0.5) / 500.0, angle = 2.4 * i;
    const double r = std::sqrt(1.0 - z * z);
    points.emplace_back(0.1 * r * std::cos(angle), 0.1 * r * std::sin(angle), 0.1 * z);
  }
  const auto hull = reducedHull(points, 64);
  ASSERT_TRUE(hull);
  EXPECT_EQ(hull->points.size(), 64U);
  const double ball_m3 = 4.0 / 3.0 * pi * 1e-3;
  EXPECT_LT(signedVolume(*hull), ball_m3);
  EXPECT_GT(signedVolume(*hull), 0.85 * ball_m3);
}

}  // namespace
}  // namespace wholehand::test
