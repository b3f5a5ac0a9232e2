#pragma once

#include "files/mesh/mesh_file.hpp"

#include <Eigen/Core>

#include <cmath>
#include <numbers>
#include <vector>

namespace wholehand::test {

/// Adds a quadrilateral. It is wound outward if its corners run counterclockwise seen from outside.
inline void addQuad(MeshSurface& mesh, int a, int b, int c, int d) {
  mesh.triangles.emplace_back(a, b, c);
  mesh.triangles.emplace_back(a, c, d);
}

/// A prism over a counterclockwise polygon whose corner 0 sees every other corner.
inline MeshSurface prism(const std::vector<Eigen::Vector2d>& outline_m, double height_m) {
  MeshSurface mesh;
  const int n = static_cast<int>(outline_m.size());
  for (const double z : {0.0, height_m}) {
    for (const Eigen::Vector2d& p : outline_m) mesh.points.emplace_back(p.x(), p.y(), z);
  }
  for (int i = 0; i < n; ++i) addQuad(mesh, i, (i + 1) % n, n + (i + 1) % n, n + i);
  for (int i = 1; i + 1 < n; ++i) {
    mesh.triangles.emplace_back(0, i + 1, i);
    mesh.triangles.emplace_back(n, n + i, n + i + 1);
  }
  return mesh;
}

/// An L of two boxes: 60 x 20 x 20 mm and 20 x 40 x 20 mm; 40 cm3. Corner 0 is the reflex edge.
inline MeshSurface lShape() {
  return prism({{0.02, 0.02}, {0.02, 0.06}, {0.0, 0.06}, {0.0, 0.0}, {0.06, 0.0}, {0.06, 0.02}},
               0.02);
}

/// A solid of revolution about z, of a closed counterclockwise profile (radius, z) in `around`
/// steps.
inline MeshSurface revolved(const std::vector<Eigen::Vector2d>& profile_m, int around) {
  MeshSurface mesh;
  const int n = static_cast<int>(profile_m.size());
  for (int i = 0; i < around; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / around;
    for (const Eigen::Vector2d& p : profile_m) {
      mesh.points.emplace_back(p.x() * std::cos(angle), p.x() * std::sin(angle), p.y());
    }
  }
  for (int i = 0; i < around; ++i) {
    const int here = i * n, next = (i + 1) % around * n;
    for (int k = 0; k < n; ++k) {
      addQuad(mesh, here + k, next + k, next + (k + 1) % n, here + (k + 1) % n);
    }
  }
  return mesh;
}

inline MeshSurface torus(double ring_m, double tube_m, int around, int across) {
  std::vector<Eigen::Vector2d> profile;
  for (int k = 0; k < across; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / across;
    profile.emplace_back(ring_m + tube_m * std::cos(angle), tube_m * std::sin(angle));
  }
  return revolved(profile, around);
}

/// A cup on the plane z = 0: 90 mm high, outer radius 35 mm, wall and floor 4 mm thick.
inline MeshSurface cup(int around) {
  return revolved(
      {{0.0, 0.0}, {0.035, 0.0}, {0.035, 0.09}, {0.031, 0.09}, {0.031, 0.004}, {0.0, 0.004}},
      around);
}

}  // namespace wholehand::test
