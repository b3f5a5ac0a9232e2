#pragma once

#include "loop/core/real_time.hpp"
#include "loop/model/scene_model.hpp"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <LinearMath/btTransform.h>

#include <array>

class btCollisionObject;

namespace wholehand::bullet {

/// An edge that protrudes by less than this counts as flush: it stops nothing.
inline constexpr double kFlush_m = 3e-5;

/// Contact points of two convex colliders in this step, without points of earlier steps: an older
/// point lies behind a body that rolls, and would push it on.
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
/// (Gilbert, Johnson, Keerthi 1988). The patch is the common part of their faces, edges or corners
/// farthest along this direction, seen along it. Distances are exact for faces, edges and rims. If
/// the patch has more than four corners, four are kept, including both corners of the edge near
/// which the bodies pressed in the last step.
///
/// A collider that overlaps the extension of another's face by less than kFlush_m counts as lying
/// on that face, so that an edge between two flush pieces stops nothing.
/// @param a, b objects with convex shapes @param form_a, form_b the same shapes @param reach_m
/// largest gap of a point @param before points of the last step; null: none. Real-time safe.
[[nodiscard]] WHOLEHAND_RT ContactPatch findPatch(const btCollisionObject& a, const Shape& form_a,
                                                  const btCollisionObject& b, const Shape& form_b,
                                                  double reach_m,
                                                  const btPersistentManifold* before) noexcept;

/// Replaces the points of a manifold. A new point inherits the impulses and the drift of the
/// nearest old point. Real-time safe.
WHOLEHAND_RT void renew(btPersistentManifold& manifold, const ContactPatch& patch) noexcept;

/// Copies the impulses and the drift of one point to another. Real-time safe.
WHOLEHAND_RT void inherit(btManifoldPoint& heir, const btManifoldPoint& from) noexcept;

}  // namespace wholehand::bullet
