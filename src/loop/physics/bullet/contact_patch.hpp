#pragma once

#include "loop/core/real_time.hpp"
#include "loop/model/scene_model.hpp"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <LinearMath/btTransform.h>

#include <array>

class btCollisionObject;

namespace wholehand::bullet {

/// A step of this height stops nothing.
inline constexpr double kFlush_m = 3e-5;

/// Where two convex colliders touch now: the points of this step and no older ones. A point of an
/// earlier step lies behind a body that rolls and pushes it on.
struct ContactPatch {
  struct Point {
    btVector3 on_b;    ///< on the second collider's surface, world
    btVector3 normal;  ///< unit, from the second collider to the first
    double gap_m = 0.0;
  };
  static constexpr int kMost = MANIFOLD_CACHE_SIZE;
  std::array<Point, kMost> points;
  int count = 0;

  void add(const Point& point) noexcept {
    if (count < kMost) points[count++] = point;
  }
};

/// Finds the patch of two colliders. The direction comes from the nearest points of the two shapes
/// (Gilbert, Johnson, Keerthi 1988); the patch is what their faces, edges or corners farthest along
/// it have in common, seen along it. Its distances are exact for faces, edges and rims. Of more
/// than four corners it has four, with the whole edge that the bodies pressed near in the last
/// step.
///
/// A collider that overlaps the extension of another's face by less than kFlush_m is taken to lie
/// on it: an edge between two flush pieces stops nothing.
/// @param a, b with convex shapes @param form_a, form_b the same shapes @param reach_m largest gap
/// of a point @param before points of the last step; null: none. Real-time safe.
[[nodiscard]] WHOLEHAND_RT ContactPatch findPatch(const btCollisionObject& a, const Shape& form_a,
                                                  const btCollisionObject& b, const Shape& form_b,
                                                  double reach_m,
                                                  const btPersistentManifold* before) noexcept;

/// Replaces the points of a manifold. A new point takes the impulses and the drift of the nearest
/// point before. Real-time safe.
WHOLEHAND_RT void renew(btPersistentManifold& manifold, const ContactPatch& patch) noexcept;

/// Gives a point the impulses and the drift of another. Real-time safe.
WHOLEHAND_RT void inherit(btManifoldPoint& heir, const btManifoldPoint& from) noexcept;

}  // namespace wholehand::bullet
