#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "core/world_query.hpp"

#include <array>

namespace wholehand {

/// What the world looks like before a step.
struct WorldState {
  AxisPosition q_s;  ///< reduced coordinates of the hand
  AxisVelocity qd_s;
  JointPosition theta;  ///< joint coordinates, θ = θ₀ + G q_s
  JointVelocity theta_dot;
  double coupling_error_rad = 0.0;  ///< what the last step left of |θ - (θ₀ + G q_s)|, uncorrected
  double palm_distance_m = 0.0;     ///< palm surface to the nearest body; +inf without bodies
  int palm_body = -1;               ///< nearest of the query's targets; -1: none
  double palm_target_distance_m = 0.0;  ///< to that body; < 0 unless before the palm; +inf without
  /// First touch of each hand axis with the query's closure body (physics/axis_closure.hpp).
  AxisPosition closure;
  int body_count = 0;
  std::array<BodyState, kMaxBodies> bodies{};
};

/// What drives the hand through one step, computed at the state that observe() gave.
struct HandDrive {
  JointEffort torque;                                   ///< τ = M G M_r⁻¹ f_s + h
  AxisRatio armature;                                   ///< A [kg or kg·m²]; size 0: none
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
/// of it shows here. All but construction and placeHand() are real-time safe.
class PhysicsWorld {
 public:
  virtual ~PhysicsWorld() = default;

  /// Puts the hand at q_s, at rest, without stepping; bodies stay where they are. An error names
  /// what it would overlap. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> placeHand(const AxisPosition& q_s) = 0;

  /// The state before the next step, and what an exercise wants to know of it. `state` is the one
  /// of the last call: a first touch may be refined from tick to tick.
  [[nodiscard]] WHOLEHAND_RT virtual Fault observe(const WorldQuery& query,
                                                   WorldState& state) noexcept = 0;

  /// Puts bodies where an exercise wants them; a fixed one has its velocity for one step only.
  WHOLEHAND_RT virtual void placeBodies(const BodyPlacements& placements) noexcept = 0;

  /// Advances by exactly one step of period_s.
  [[nodiscard]] WHOLEHAND_RT virtual Fault step(const HandDrive& drive,
                                                double period_s) noexcept = 0;

  /// Where the hand touched bodies in the last step, with the forces of that step.
  WHOLEHAND_RT virtual void contacts(ContactList& contacts) const noexcept = 0;
};

}  // namespace wholehand
