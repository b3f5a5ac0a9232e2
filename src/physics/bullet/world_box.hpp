#pragma once

#include <Eigen/Core>

#include <limits>

namespace wholehand::bullet {

/// An axis-aligned box in the world frame. Initially empty.
struct WorldBox {
  Eigen::Vector3d low_m = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector3d high_m = Eigen::Vector3d::Constant(-std::numeric_limits<double>::infinity());
};

/// Real-time safe.
[[nodiscard]] inline bool overlap(const WorldBox& a, const WorldBox& b) noexcept {
  return a.low_m.x() <= b.high_m.x() && b.low_m.x() <= a.high_m.x() &&
         a.low_m.y() <= b.high_m.y() && b.low_m.y() <= a.high_m.y() &&
         a.low_m.z() <= b.high_m.z() && b.low_m.z() <= a.high_m.z();
}

/// Whether `inner` lies within `outer`; false for NaN. Real-time safe.
[[nodiscard]] inline bool contains(const WorldBox& outer, const WorldBox& inner) noexcept {
  return (outer.low_m.array() <= inner.low_m.array()).all() &&
         (inner.high_m.array() <= outer.high_m.array()).all();
}

}  // namespace wholehand::bullet
