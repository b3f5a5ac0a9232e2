#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "core/world_query.hpp"
#include "physics/self_forces.hpp"

#include <array>

namespace wholehand {

class ArticulatedBody;

/// State of the world before a step.
struct PhysicsState {
  AxisPosition q_s;  ///< reduced coordinates of the hand
  AxisVelocity qd_s;
  JointPosition theta;  ///< joint coordinates, θ = θ₀ + G q_s
  JointVelocity theta_dot;
  /// Kinematics at theta, until the next step, of an engine that has them; nullptr: none.
  const ArticulatedBody* kinematics = nullptr;
  double coupling_error_rad = 0.0;  ///< |θ - (θ₀ + G q_s)| after the last step, before correction
  int body_count = 0;               ///< bodies of the scene and slots of a game, at most kMaxBodies
  std::array<BodyState, kMaxBodies> bodies{};
};

/// Input that drives the hand through a step, computed at the state that observe() returned.
struct HandDrive {
  AxisEffort effort;     ///< f_s, for engines that integrate q_s [N or N·m]
  JointEffort torque;    ///< τ = M G M_r⁻¹ f_s + h, for engines that integrate θ [N or N·m]
  AxisInertia armature;  ///< A; size 0: none
  AxisEffort armature_effort;                           ///< A M_r⁻¹ f_s, of the same size
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
/// following, which tests/physics/engine_conformance verifies:
///
/// - A step, and whatever is marked so, allocates nothing, takes no lock, throws nothing, prints
///   nothing and never ends the program: what it cannot do is a Fault.
/// - Two worlds built alike and called alike give bit-identical results.
/// - The joints keep θ = θ₀ + G q_s, also under contact, and contact forces do the virtual work of
///   f_s: with the hand at rest, f_s = -Σ Gᵀ Jᵀ force.
/// - Without contact the hand moves by q̈_s = M_r⁻¹ f_s: h carries gravity and velocity terms.
/// - Contacts never pull, and stay in the friction cone of μ = √(μ_hand μ_body).
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

  /// Places bodies for an exercise, before a step; observe() shows it at once. A free body
  /// continues with the given velocity and without rotation. A fixed body stays there: its velocity
  /// is that of its surface in the next step only, and does not move it. An invalid placement is
  /// ignored.
  WHOLEHAND_RT virtual void placeBodies(const BodyPlacements& placements) noexcept = 0;

  /// Advances by exactly one step of period_s. After a fault only observe() is guaranteed to be
  /// correct.
  [[nodiscard]] WHOLEHAND_RT virtual Fault step(const HandDrive& drive,
                                                double period_s) noexcept = 0;

  /// Contacts of the hand with bodies in the last step: forces of that step; points and distances
  /// from before it.
  WHOLEHAND_RT virtual void contacts(ContactList& contacts) const noexcept = 0;

  /// Self-contact forces of the last step. They act on q_s and so on the felt effort; no record
  /// holds them.
  WHOLEHAND_RT virtual void selfForces(SelfForces& forces) const noexcept = 0;

  /// Bodies of a game; null in an engine that has none.
  [[nodiscard]] virtual BodyPool* bodyPool() noexcept { return nullptr; }
};

}  // namespace wholehand
