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
  int body_count = 0;
  std::array<BodyState, kMaxBodies> bodies{};
};

/// What drives the hand through one step, computed at the state that observe() gave.
struct HandDrive {
  AxisEffort effort;           ///< f_s, for engines that integrate q_s
  JointEffort torque;          ///< τ = M G M_r⁻¹ f_s + h, for engines that integrate θ
  AxisRatio armature;          ///< A [kg or kg·m²]; size 0: none
  AxisEffort armature_effort;  ///< A M_r⁻¹ f_s, of the same size
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

  /// The state before the next step.
  [[nodiscard]] WHOLEHAND_RT virtual Fault observe(WorldState& state) noexcept = 0;

  /// Puts bodies where an exercise wants them; a fixed one has its velocity for one step only.
  WHOLEHAND_RT virtual void placeBodies(const BodyPlacements& placements) noexcept = 0;

  /// Advances by exactly one step of period_s.
  [[nodiscard]] WHOLEHAND_RT virtual Fault step(const HandDrive& drive,
                                                double period_s) noexcept = 0;

  /// Where the hand touched bodies in the last step, with the forces of that step.
  WHOLEHAND_RT virtual void contacts(ContactList& contacts) const noexcept = 0;
};

}  // namespace wholehand
