#pragma once

#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

namespace wholehand {

/// A body on one joint to the world. Its one coordinate q is integrated and its pose follows from
/// q, so that the joint has no error. With a the twist of the body's centre of mass per unit of q̇
/// its inertia is m_q = aᵀ M a: I + m|r|² of a hinge, m of a slide.
///
/// Spring, viscous friction and the rising slopes of the latch are implicit: they take part in the
/// inertia by which an impulse changes q̇, m_q + T c + T² k. So no step feeds energy into the hand.
/// Gravity and the latch's falling slopes are explicit (symplectic Euler).
class BodyJoint {
 public:
  /// Velocity of the centre of mass and spin, per unit of q̇, in the world.
  struct Twist {
    Eigen::Vector3d linear, angular;
  };

  /// @pre body.joint, mass and inertia are there
  explicit BodyJoint(const SceneBody& body);

  [[nodiscard]] double position() const noexcept { return q_; }
  [[nodiscard]] double rate() const noexcept { return rate_; }
  /// Pose of the scene's body frame in the world. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Pose pose() const noexcept { return poseOn(joint_, start_, q_); }
  /// Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Twist twist() const noexcept;
  /// m_q
  [[nodiscard]] double inertia() const noexcept { return inertia_; }

  /// Takes q and q̇ as they are. Real-time safe.
  void put(double q, double rate) noexcept {
    q_ = q;
    rate_ = rate;
  }
  /// As positionOn(). Real-time safe.
  [[nodiscard]] WHOLEHAND_RT double nearest(const Pose& pose) const noexcept {
    return positionOn(joint_, start_, pose);
  }

  /// Begins a step: q̇ at its end without contacts, ends and dry friction. Real-time safe.
  WHOLEHAND_RT void predict(const Eigen::Vector3d& gravity_m_s2, double step_s) noexcept;
  /// Change of q̇ per impulse in this step.
  [[nodiscard]] double yield() const noexcept { return yield_; }
  /// Bound of the impulse of dry friction in this step: F_c T.
  [[nodiscard]] double mostFriction() const noexcept { return friction_impulse_; }
  /// Bounds of q̇ in this step, which lead to the ends.
  [[nodiscard]] double leastRate() const noexcept { return least_rate_; }
  [[nodiscard]] double mostRate() const noexcept { return most_rate_; }
  /// Ends the step with q̇ as contacts, ends and dry friction left it. Real-time safe.
  WHOLEHAND_RT void move(double rate, double step_s) noexcept;

  /// Energy of motion, spring and latch [J].
  [[nodiscard]] double energy() const noexcept;

 private:
  SceneJoint joint_;
  Pose start_;             ///< of the body frame at q = 0
  Eigen::Vector3d axis_;   ///< world
  Eigen::Vector3d arm_m_;  ///< from the hinge's point to the centre of mass at q = 0
  double mass_kg_;
  double inertia_ = 0.0;
  double q_ = 0.0, rate_ = 0.0;
  double yield_ = 0.0, friction_impulse_ = 0.0, least_rate_ = 0.0, most_rate_ = 0.0;
};

}  // namespace wholehand
