#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "core/world_query.hpp"
#include "physics/self_forces.hpp"

#include <array>

namespace wholehand {

/// What the world looks like before a step.
struct WorldState {
  AxisPosition q_s;  ///< reduced coordinates of the hand
  AxisVelocity qd_s;
  JointPosition theta;  ///< joint coordinates, θ = θ₀ + G q_s
  JointVelocity theta_dot;
  double coupling_error_rad = 0.0;  ///< what the last step left of |θ - (θ₀ + G q_s)|, uncorrected
  int body_count = 0;
  std::array<BodyState, kMaxBodies> bodies{};
};

/// What drives the hand through one step, computed at the state that observe() gave.
struct HandDrive {
  AxisEffort effort;   ///< f_s, for engines that integrate q_s [N or N·m]
  JointEffort torque;  ///< τ = M G M_r⁻¹ f_s + h, for engines that integrate θ [N or N·m]
  AxisRatio armature;  ///< A [kg or kg·m²]; size 0: none
  AxisEffort armature_effort;                           ///< A M_r⁻¹ f_s, of the same size
  const AxisMatrix* reduced_inertia_inverse = nullptr;  ///< M_r⁻¹, armature included; without it an
                                                        ///< engine may refuse
};

/// The touching points of the last step.
struct ContactList {
  int count = 0;
  int dropped = 0;
  std::array<Contact, kMaxContacts> points{};
};

/// A physics engine with one hand and the bodies of one scene in it. The engine is a plug: nothing
/// of it shows here. SI units, radians, the world's axes (docs/equations.md). What every engine
/// keeps, and tests/physics/engine_conformance holds it to:
///
/// - A step, and whatever is marked so, allocates nothing, takes no lock, throws nothing, prints
///   nothing and never ends the program: what it cannot do is a Fault.
/// - Two worlds built alike and asked alike give the same bits.
/// - The joints keep θ = θ₀ + G q_s, also under contact, and contact forces do the virtual work of
///   f_s: with the hand at rest, f_s = -Σ Gᵀ Jᵀ force.
/// - Untouched the hand moves by q̈_s = M_r⁻¹ f_s: h carries gravity and velocity terms.
/// - Contacts never pull, and stay in the friction cone of μ = √(μ_hand μ_body).
class PhysicsWorld {
 public:
  virtual ~PhysicsWorld() = default;

  /// Puts the hand at q_s, at rest, without stepping; bodies stay where they are, and contacts of
  /// before are forgotten. An error names what it would overlap by more than 0.2 mm. Not real-time
  /// safe.
  [[nodiscard]] virtual Expected<Done> placeHand(const AxisPosition& q_s) = 0;

  /// The state before the next step. A body's position is that of its centre of mass, its
  /// orientation that of the scene's body frame.
  [[nodiscard]] WHOLEHAND_RT virtual Fault observe(WorldState& state) noexcept = 0;

  /// Puts bodies where an exercise wants them, before a step; observe() shows it at once. A free
  /// body flies on from there with the velocity given and no longer turns. A fixed one stays there:
  /// its velocity is that of its surface in the next step only, and moves it no further. A
  /// placement that is no pose, or of no body, is ignored.
  WHOLEHAND_RT virtual void placeBodies(const BodyPlacements& placements) noexcept = 0;

  /// Advances by exactly one step of period_s. After a fault other than kNone nothing is promised
  /// but that observe() tells the truth.
  [[nodiscard]] WHOLEHAND_RT virtual Fault step(const HandDrive& drive,
                                                double period_s) noexcept = 0;

  /// Where the hand touched bodies in the last step, with the forces of that step; points and
  /// distances as they were before it.
  WHOLEHAND_RT virtual void contacts(ContactList& contacts) const noexcept = 0;

  /// What the hand did to itself in the last step. It acts on q_s and so on what is felt; no record
  /// holds it.
  WHOLEHAND_RT virtual void selfForces(SelfForces& forces) const noexcept = 0;
};

}  // namespace wholehand
