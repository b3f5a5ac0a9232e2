#pragma once

#include "core/geometry.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A spatial vector in world axes about the world origin: a twist (angular velocity, velocity of
/// the body point at the origin) or a wrench (moment about the origin, force).
struct SpatialVector {
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();
  Eigen::Vector3d linear = Eigen::Vector3d::Zero();

  SpatialVector& operator+=(const SpatialVector& o) noexcept {
    angular += o.angular;
    linear += o.linear;
    return *this;
  }
};

/// Power of a wrench on a twist [W]. Real-time safe.
[[nodiscard]] inline double dot(const SpatialVector& a, const SpatialVector& b) noexcept {
  return a.angular.dot(b.angular) + a.linear.dot(b.linear);
}

/// Cross product by components. Eigen's own goes through temporaries at -O2.
[[nodiscard]] inline Eigen::Vector3d cross(const Eigen::Vector3d& a,
                                           const Eigen::Vector3d& b) noexcept {
  return {a.y() * b.z() - a.z() * b.y(), a.z() * b.x() - a.x() * b.z(),
          a.x() * b.y() - a.y() * b.x()};
}

/// Rate of change of twist `m` fixed in a body that moves with twist `v`. Real-time safe.
[[nodiscard]] inline SpatialVector crossMotion(const SpatialVector& v,
                                               const SpatialVector& m) noexcept {
  return {cross(v.angular, m.angular), cross(v.angular, m.linear) + cross(v.linear, m.angular)};
}

/// Rate of change of wrench `f` fixed in a body that moves with twist `v`. Real-time safe.
[[nodiscard]] inline SpatialVector crossForce(const SpatialVector& v,
                                              const SpatialVector& f) noexcept {
  return {cross(v.angular, f.angular) + cross(v.linear, f.linear), cross(v.angular, f.linear)};
}

/// Inertia of a rigid body, or of several welded ones, in world axes about the world origin.
/// Inertias in one frame add; the composite-rigid-body algorithm relies on it.
struct SpatialInertia {
  double mass_kg = 0.0;
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();  ///< mass * centre of mass [kg·m]
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;  ///< about the origin [kg·m²]

  SpatialInertia& operator+=(const SpatialInertia& o) noexcept {
    mass_kg += o.mass_kg;
    first_moment += o.first_moment;
    xx += o.xx;
    yy += o.yy;
    zz += o.zz;
    xy += o.xy;
    xz += o.xz;
    yz += o.yz;
    return *this;
  }

  /// Momentum of the body under a twist. Real-time safe.
  [[nodiscard]] SpatialVector operator*(const SpatialVector& v) const noexcept {
    const Eigen::Vector3d& w = v.angular;
    const Eigen::Vector3d turned(xx * w.x() + xy * w.y() + xz * w.z(),
                                 xy * w.x() + yy * w.y() + yz * w.z(),
                                 xz * w.x() + yz * w.y() + zz * w.z());
    return {turned + cross(first_moment, v.linear), mass_kg * v.linear - cross(first_moment, w)};
  }
};

/// World-frame inertia of a body of the given mass, centre and inertia (about the centre, body
/// axes). Real-time safe.
[[nodiscard]] inline SpatialInertia inertiaInWorld(double mass_kg, const Eigen::Vector3d& com_m,
                                                   const Eigen::Matrix3d& inertia_kg_m2,
                                                   const Pose& body) noexcept {
  const Eigen::Matrix3d& r = body.rotation;
  const Eigen::Vector3d c = body * com_m;
  const Eigen::Matrix3d ri = r * inertia_kg_m2;
  const auto turned = [&](int i, int j) {
    return ri(i, 0) * r(j, 0) + ri(i, 1) * r(j, 1) + ri(i, 2) * r(j, 2);
  };
  SpatialInertia out;
  out.mass_kg = mass_kg;
  out.first_moment = mass_kg * c;
  out.xx = turned(0, 0) + mass_kg * (c.y() * c.y() + c.z() * c.z());
  out.yy = turned(1, 1) + mass_kg * (c.x() * c.x() + c.z() * c.z());
  out.zz = turned(2, 2) + mass_kg * (c.x() * c.x() + c.y() * c.y());
  out.xy = turned(0, 1) - mass_kg * c.x() * c.y();
  out.xz = turned(0, 2) - mass_kg * c.x() * c.z();
  out.yz = turned(1, 2) - mass_kg * c.y() * c.z();
  return out;
}

}  // namespace wholehand
