#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/body_order.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/core/world_query.hpp"

#include <array>
#include <cmath>
#include <string>

namespace wholehand {

/// True when every number of the body's state is finite. Real-time safe.
[[nodiscard]] inline bool allFinite(const BodyState& body) noexcept {
  return body.position_m.eigen().allFinite() && body.velocity_m_s.eigen().allFinite() &&
         body.angular_velocity_rad_s.eigen().allFinite() &&
         body.orientation_xyzw.eigen().coeffs().allFinite();
}

/// True when a body can be placed there. Real-time safe.
[[nodiscard]] inline bool isPose(const BodyPlacement& placement) noexcept {
  return placement.position_m.eigen().allFinite() && placement.velocity_m_s.eigen().allFinite() &&
         std::abs(placement.orientation_xyzw.eigen().squaredNorm() - 1.0) < 0.1;
}

/// Error for placing a hand while a body's state is not finite.
[[nodiscard]] inline Diagnostic nonFiniteBodyError(const std::string& scene_path,
                                                   const std::string& body) {
  return {scene_path, 0, "bodies." + body, "", "is nowhere after a fault", "build the scene anew"};
}

/// Largest number of reported self-contacts; further ones act, but are not reported.
inline constexpr int kMaxSelfForces = 64;

/// Self-contact point of two capsules after a step. World frame.
struct SelfForce {
  int capsule_a = -1, capsule_b = -1;  ///< indices into HandModel::capsules
  Vec3 point_m;
  Vec3 normal;              ///< unit, from b to a
  Vec3 force_n;             ///< on a, normal and friction; b gets the opposite
  double distance_m = 0.0;  ///< before the step; negative when the surfaces overlap
};

/// Self-contact forces of the last step.
struct SelfForces {
  int count = 0;
  std::array<SelfForce, kMaxSelfForces> touches{};
  AxisEffort joint_ends;  ///< efforts of joints at the end of their range, per axis [N or N·m]
};

/// The bodies of a game in a physics world: a pool of slots that exist from the start
/// (docs/adr/0043-bodies-of-a-game.md). An engine that supports games implements it together with
/// PhysicsWorld. Every function is real-time safe and deterministic: the same commands in the same
/// ticks give the same bits.
class BodyPool {
 public:
  virtual ~BodyPool() = default;

  /// Obeys one command, before a step; commands that are no body orders are ignored. An order that
  /// cannot be carried out changes nothing and stands in the next report().
  WHOLEHAND_RT virtual void apply(const Command& command) noexcept = 0;
  /// Sets whether the game is alive; call before every step. While the game is silent, the force of
  /// driven bodies fades within 0.2 s; after 5 s all bodies of the game are removed.
  WHOLEHAND_RT virtual void setGameAlive(bool alive) noexcept = 0;
  /// Reports the slots and the orders refused since the last report.
  WHOLEHAND_RT virtual void report(PoolReport& report) noexcept = 0;
};

class ArticulatedBody;

/// State of the world before a step.
struct PhysicsState {
  AxisPosition q_s;  ///< reduced coordinates of the hand
  AxisVelocity qd_s;
  JointPosition theta;  ///< joint coordinates, θ = θ₀ + G q_s
  JointVelocity theta_dot;
  /// Kinematics at theta, valid until the next step; nullptr when the engine has none.
  const ArticulatedBody* kinematics = nullptr;
  double coupling_error_rad = 0.0;  ///< |θ - (θ₀ + G q_s)| after the last step, before correction
  int body_count = 0;               ///< bodies of the scene and slots of a game, at most kMaxBodies
  std::array<BodyState, kMaxBodies> bodies{};
  int body_joint_count = 0;                  ///< of these bodies, those on joints, ascending
  std::array<double, kMaxBodies> body_q{};   ///< positions of their joints [m or rad]
  std::array<double, kMaxBodies> body_qd{};  ///< their rates [m/s or rad/s]
};

/// Input that drives the hand through a step, computed for the state that observe() returned.
struct HandDrive {
  AxisEffort effort;     ///< f_s, for engines that integrate q_s [N or N·m]
  JointEffort torque;    ///< τ = M G M_r⁻¹ f_s + h, for engines that integrate θ [N or N·m]
  AxisInertia armature;  ///< A; size 0: none
  AxisEffort armature_effort;                           ///< A M_r⁻¹ f_s; same size as armature
  const AxisMatrix* reduced_inertia_inverse = nullptr;  ///< M_r⁻¹, armature included; without it an
                                                        ///< engine may refuse
};

/// Contact points of the last step.
struct ContactList {
  int count = 0;
  int dropped = 0;
  std::array<Contact, kMaxContacts> points{};
};

class BodyPool;

/// A physics engine with one hand and the bodies of one scene in it. The interface exposes nothing
/// of the engine. SI units, radians, world frame (docs/equations.md). Every engine guarantees the
/// following, which tests/loop/physics/engine_conformance verifies:
///
/// - A step, and every function marked WHOLEHAND_RT, allocates nothing, takes no lock, throws
///   nothing, prints nothing and never ends the program: a failure is reported as a Fault.
/// - Two worlds built alike and called alike give bit-identical results.
/// - The joints keep θ = θ₀ + G q_s, also under contact, and contact forces do the virtual work of
///   f_s: with the hand at rest, f_s = -Σ Gᵀ Jᵀ force.
/// - Without contact the hand moves by q̈_s = M_r⁻¹ f_s: h carries gravity and velocity terms.
/// - Contact forces never pull, and stay in the friction cone of μ = √(μ_hand μ_body).
class PhysicsWorld {
 public:
  virtual ~PhysicsWorld() = default;

  /// Places the hand at q_s, at rest, without stepping. Bodies stay, and earlier contacts are
  /// cleared. An error names the bodies that it would overlap by more than 0.2 mm. Not real-time
  /// safe.
  [[nodiscard]] virtual Expected<Done> placeHand(const AxisPosition& q_s) = 0;

  /// Returns the state before the next step. A body's position is that of its centre of mass, its
  /// orientation that of the scene's body frame.
  [[nodiscard]] WHOLEHAND_RT virtual Fault observe(PhysicsState& state) noexcept = 0;

  /// Places bodies for an exercise, before a step; observe() shows the result at once. A free body
  /// continues with the given velocity and without rotation. A fixed body stays at the given pose:
  /// its velocity is only that of its surface in the next step, and does not move it. An invalid
  /// placement is ignored.
  WHOLEHAND_RT virtual void placeBodies(const BodyPlacements& placements) noexcept = 0;

  /// Advances by exactly one step of period_s. After a fault only observe() is guaranteed to be
  /// correct.
  [[nodiscard]] WHOLEHAND_RT virtual Fault step(const HandDrive& drive,
                                                double period_s) noexcept = 0;

  /// Contacts of the hand with bodies in the last step: forces of that step; points and distances
  /// from the state before it.
  WHOLEHAND_RT virtual void contacts(ContactList& contacts) const noexcept = 0;

  /// Self-contact forces of the last step. They act on q_s and therefore on the felt effort; no
  /// record holds them.
  WHOLEHAND_RT virtual void selfForces(SelfForces& forces) const noexcept = 0;

  /// The bodies of a game; null in an engine that does not support them.
  [[nodiscard]] virtual BodyPool* bodyPool() noexcept { return nullptr; }
};

}  // namespace wholehand
