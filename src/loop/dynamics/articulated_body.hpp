#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/hand_model.hpp"

#include <Eigen/Core>

#include <array>

namespace wholehand {

/// Inverse of a symmetric positive definite matrix by Cholesky factorisation. Returns false and a
/// zero inverse when a pivot is not positive and finite. Real-time safe: no heap.
[[nodiscard]] WHOLEHAND_RT bool invertPositiveDefinite(const AxisMatrix& matrix,
                                                       AxisMatrix& inverse) noexcept;

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

/// Cross product by components: at -O2 Eigen's own uses temporaries.
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

/// Most links of a hand, locked joints included.
inline constexpr int kMaxLinks = 40;

/// Joint-space dynamics of the hand, and their reduction by the synergy map G.
///
///   M(θ) θ̈ + h(θ, θ̇) = τ          (paper Eq. 1)
///   M_r = Gᵀ M G + A,  h_r = Gᵀ h   (G constant)
///
/// A is the armature: reflected inertia, diagonal, on the reduced coordinates. It contributes to
/// every acceleration and contact and has no weight.
///
/// h by the recursive Newton-Euler algorithm, M by the composite-rigid-body algorithm, both in
/// world axes about the world origin. Storage is fixed; nothing allocates after construction.
class ArticulatedBody {
 public:
  /// @pre hand outlives this; links <= kMaxLinks
  /// @param armature A of every axis [kg or kg·m²]; empty: none
  explicit ArticulatedBody(const HandModel& hand, const AxisInertia& armature = {});

  /// Updates link frames only: pose of every link, joint axes and origins in the world. Real-time
  /// safe.
  WHOLEHAND_RT void updateKinematics(const JointPosition& theta) noexcept;

  /// Updates kinematics, h, M, M_r, h_r and M_r⁻¹ (Cholesky). Returns false when M_r is not
  /// positive definite; the inverse is then zero. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT bool update(const JointPosition& theta, const JointVelocity& theta_dot,
                                         const Eigen::Vector3d& gravity_m_s2) noexcept;
  /// Like update(), but takes the kinematics from another body of the same hand, which were updated
  /// at θ already. The bits are those of update() at that θ. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT bool updateFrom(const ArticulatedBody& placed,
                                             const JointVelocity& theta_dot,
                                             const Eigen::Vector3d& gravity_m_s2) noexcept;

  /// Computes the joint torques τ = M G a + h with a = M_r⁻¹ f_s. Their reduced force is f_s + h_r
  /// − A a, and they preserve the synergy θ = θ₀ + G q_s. Real-time safe.
  WHOLEHAND_RT void distribute(const AxisEffort& f_s, JointEffort& torque) const noexcept;
  /// Effort A a, the part of f_s that accelerates the armature. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT AxisEffort armatureEffort(const AxisEffort& f_s) const noexcept;

  /// Row of the reduced Jacobian: velocity per axis of the link's material point at `point_m`
  /// (world) along `direction` (world), j = Gᵀ Jᵀ direction. Real-time safe.
  WHOLEHAND_RT void reducedPointRow(int link, const Eigen::Vector3d& point_m,
                                    const Eigen::Vector3d& direction,
                                    double* row /* axis_count */) const noexcept;
  /// The same for the link's angular velocity about `direction`.
  WHOLEHAND_RT void reducedAngularRow(int link, const Eigen::Vector3d& direction,
                                      double* row /* axis_count */) const noexcept;

  /// The rows of a contact, with the bits of reducedPointRow() along three directions and of
  /// reducedAngularRow() about the first, in one walk down the chain. Real-time safe.
  WHOLEHAND_RT void reducedContactRows(
      int link, const Eigen::Vector3d& point_m, const std::array<Eigen::Vector3d, 3>& directions,
      const std::array<double*, 4>& rows /* axis_count each */) const noexcept;

  [[nodiscard]] const JointEffort& bias() const noexcept { return bias_; }                ///< h
  [[nodiscard]] const JointMatrix& inertia() const noexcept { return inertia_; }          ///< M
  [[nodiscard]] const AxisEffort& reducedBias() const noexcept { return reduced_bias_; }  ///< h_r
  [[nodiscard]] const AxisMatrix& reducedInertia() const noexcept { return reduced_inertia_; }
  [[nodiscard]] const AxisMatrix& reducedInertiaInverse() const noexcept {
    return reduced_inertia_inverse_;
  }
  [[nodiscard]] const Pose& linkPose(int link) const noexcept { return pose_[link]; }
  [[nodiscard]] const HandModel& hand() const noexcept { return *hand_; }

 private:
  /// A driven joint and everything welded to the link it carries (locked joints are welds).
  struct Body {
    int parent = -1;  ///< index of the parent body, -1 for the world; always < own index
    int link = 0;     ///< the link whose frame is the body's frame
    int joint = 0;
    bool revolute = false;
    Eigen::Vector3d axis;  ///< body frame
    int along = -1;        ///< coordinate axis parallel to `axis`, in either sense; -1: none
    Pose parent_to_body;   ///< at joint position zero; for parent -1 in the world
    bool turned = false;   ///< parent_to_body has a rotation
    double mass_kg = 0.0;
    Eigen::Vector3d com_m = Eigen::Vector3d::Zero();
    Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();  ///< about com_m
    int first_term = 0, end_term = 0;                         ///< range of its row of G in terms_
  };
  /// A link fixed to a body.
  struct Weld {
    int link = 0;
    int body = -1;  ///< -1: fixed in the world
    Pose body_to_link;
  };
  /// One non-zero element of G.
  struct Term {
    int axis = 0;
    double ratio = 0.0;
  };

  /// Constants of four bodies, one number of each beside the other; the last group repeats the last
  /// body.
  struct FourBodies {
    using Each = std::array<double, 4>;
    Each mass_kg;
    std::array<Each, 3> com_m;
    std::array<Each, 9> inertia_kg_m2;  ///< by columns
  };
  /// Motion of a body at θ̈ = 0, with gravity as -g of the world.
  struct Motion {
    SpatialVector velocity, acceleration;
  };
  /// What a joint carries: a body with its descendants, and the wrench that this motion needs.
  struct Load {
    SpatialInertia inertia;
    SpatialVector wrench;
  };

  // These three are compiled for AVX as a whole, with what they call.
  void placeLinks(const JointPosition& theta) noexcept;
  bool updateDynamics(const JointVelocity& theta_dot, const Eigen::Vector3d& gravity_m_s2) noexcept;
  void sumContactRows(int link, const Eigen::Vector3d& point_m,
                      const std::array<Eigen::Vector3d, 3>& directions,
                      const std::array<double*, 4>& rows) const noexcept;
  void placeBody(int i, double position) noexcept;
  void addBody(int link, int parent, const Pose& parent_to_body);
  static void addMass(Body& body, const HandLink& link, const Pose& body_to_link);
  void sweepForward(const JointVelocity& theta_dot, const Eigen::Vector3d& gravity_m_s2) noexcept;
  void weighFour(int first) noexcept;
  void sweepBackward() noexcept;
  void reduce() noexcept;

  const HandModel* hand_;
  AxisInertia armature_;
  int body_count_ = 0, weld_count_ = 0, term_count_ = 0;
  std::array<Body, kMaxJoints> body_;
  std::array<FourBodies, kMaxJoints / 4> four_bodies_;
  std::array<Weld, kMaxLinks> weld_;
  std::array<int, kMaxLinks> body_of_link_{};
  std::array<Term, kMaxJoints * kMaxAxes> terms_;

  std::array<Pose, kMaxLinks> pose_;
  std::array<SpatialVector, kMaxJoints> screw_;  ///< velocity per unit joint velocity
  std::array<Motion, kMaxJoints> motion_;
  std::array<Load, kMaxJoints> load_;

  JointEffort bias_;
  JointMatrix inertia_;
  /// M G by columns, each as long as the next multiple of four joints.
  alignas(32) std::array<double, kMaxJoints * kMaxAxes> inertia_synergy_{};
  int inertia_synergy_height_ = 0;
  AxisEffort reduced_bias_;
  AxisMatrix reduced_inertia_;
  AxisMatrix reduced_inertia_inverse_;
};

}  // namespace wholehand
