#pragma once

#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A body on one joint to the world. Its only coordinate q is integrated, and the body's pose
/// follows from q, so the joint has no position error. With a, the twist of the centre of mass per
/// unit of q̇, the inertia is m_q = aᵀ M a: I + m|r|² for a hinge, m for a slide.
///
/// Let H = ½ m_q q̇² + V(q), V the potential of gravity, spring and latch together. No step adds to
/// H more than the impulses on the joint do (docs/adr/0091-steps-of-a-joint.md), whatever the order
/// of the two kinds of step:
/// - An untouched joint keeps H: q moves by T times the mean rate, under the mean force along the
///   way (discrete gradient). Friction takes what it should.
/// - A touched joint moves by T q̇' and is integrated implicitly: viscous friction and the slope of
///   V where it rises add to the inertia by which an impulse changes q̇, m_q + T c + T² k.
class BodyJoint {
 public:
  /// Velocity of the centre of mass and angular velocity, per unit of q̇, in the world.
  struct Twist {
    Eigen::Vector3d linear, angular;
  };

  /// @pre the body has a joint, a mass and an inertia
  explicit BodyJoint(const SceneBody& body);

  [[nodiscard]] double position() const noexcept { return q_; }
  [[nodiscard]] double rate() const noexcept { return rate_; }
  /// Pose of the scene's body frame in the world. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Pose pose() const noexcept { return poseOn(joint_, start_, q_); }
  /// Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Twist twist() const noexcept;
  /// Inertia m_q.
  [[nodiscard]] double inertia() const noexcept { return inertia_; }

  /// Sets q and q̇ without checks. Real-time safe.
  void put(double q, double rate) noexcept {
    q_ = q;
    rate_ = rate;
  }
  /// The q nearest to a pose, as positionOn(). Real-time safe.
  [[nodiscard]] WHOLEHAND_RT double nearest(const Pose& pose) const noexcept {
    return positionOn(joint_, start_, pose);
  }

  /// Begins a step: computes q̇ at its end without contacts, ends of the range and dry friction.
  /// Real-time safe. @param touched contacts may act on the body in this step
  WHOLEHAND_RT void predict(const Eigen::Vector3d& gravity_m_s2, double step_s,
                            bool touched) noexcept;
  /// Change of q̇ per unit of impulse in this step.
  [[nodiscard]] double yield() const noexcept { return yield_; }
  /// True when dry friction or an end held the joint against its load in this step: gravity, spring
  /// and latch would not start it from rest. Contacts are not counted.
  [[nodiscard]] bool loadIsHeld() const noexcept { return load_is_held_; }
  /// Bound of the impulse of dry friction in this step: F_c T.
  [[nodiscard]] double mostFriction() const noexcept { return friction_impulse_; }
  /// Bounds of q̇ in this step: at a bound the step ends exactly at an end of the range.
  [[nodiscard]] double leastRate() const noexcept { return least_rate_; }
  [[nodiscard]] double mostRate() const noexcept { return most_rate_; }
  /// Ends the step with the q̇ that contacts, ends of the range and dry friction gave; q̇ of an
  /// untouched joint is the predicted one. Real-time safe.
  WHOLEHAND_RT void move(double rate, double step_s) noexcept;

  /// Energy of motion, spring and latch [J].
  [[nodiscard]] double energy() const noexcept;

 private:
  /// Force of gravity on q̇ at q, and its derivative.
  struct Weight {
    double force = 0.0, slope = 0.0;
  };
  [[nodiscard]] Weight weightAt(const Eigen::Vector3d& gravity_m_s2) const noexcept;
  [[nodiscard]] double meanForce(const Weight& weight, double way) const noexcept;
  [[nodiscard]] double slopeOnWay(const Weight& weight, double way) const noexcept;
  [[nodiscard]] double stiffness(const Weight& weight, double most_weight,
                                 double step_s) const noexcept;
  [[nodiscard]] bool swing(const Weight& weight, double force, double step_s) noexcept;

  SceneJoint joint_;
  Pose start_;             ///< pose of the body frame at q = 0
  Eigen::Vector3d axis_;   ///< axis of the joint, world
  Eigen::Vector3d arm_m_;  ///< from the hinge's point to the centre of mass at q = 0
  double mass_kg_;
  double inertia_ = 0.0;
  double q_ = 0.0, rate_ = 0.0;
  double yield_ = 0.0, friction_impulse_ = 0.0, least_rate_ = 0.0, most_rate_ = 0.0;
  double next_q_ = 0.0;     ///< q after an untouched step
  bool untouched_ = false;  ///< this step keeps H
  bool load_is_held_ = false;
};

}  // namespace wholehand
