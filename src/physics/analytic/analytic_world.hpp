#pragma once

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "physics/physics_world.hpp"

#include <limits>
#include <vector>

namespace wholehand {

/// What the hand meets along one of its reduced coordinates. Units follow the axis.
struct AnalyticAxis {
  double lower_stop = -std::numeric_limits<double>::infinity();  ///< rigid [m or rad]
  double upper_stop = std::numeric_limits<double>::infinity();   ///< rigid [m or rad]
  double stiffness = 0.0;    ///< spring towards spring_rest [N/m or N·m/rad], >= 0
  double damping = 0.0;      ///< against the world [N·s/m or N·m·s/rad], >= 0
  double spring_rest = 0.0;  ///< [m or rad]
  double added_mass = 0.0;   ///< moves with the axis [kg or kg·m²], >= 0; weightless
};

struct AnalyticScene {
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};
  std::vector<AnalyticAxis> axes;  ///< in the device's order; missing ones are free
};

/// A world without bodies in which everything has a closed form: the hand in its reduced
/// coordinates, M_r q̈_s = Gᵀτ − h_r + springs, advanced by symplectic Euler as the engines do, and
/// rigid stops that act on velocities as a contact solver does: after a step no stop is passed, and
/// the effort that this took is reported as one contact per stopped axis (capsule and body -1).
class AnalyticWorld final : public PhysicsWorld {
 public:
  /// @pre hand outlives this
  AnalyticWorld(const HandModel& hand, AnalyticScene scene);

  [[nodiscard]] Expected<Done> placeHand(const AxisPosition& q_s) override;
  [[nodiscard]] WHOLEHAND_RT Fault observe(WorldState& state) noexcept override;
  /// There is nothing to place.
  WHOLEHAND_RT void placeBodies(const BodyPlacements& placements) noexcept override;
  [[nodiscard]] WHOLEHAND_RT Fault step(const HandDrive& drive, double period_s) noexcept override;
  WHOLEHAND_RT void contacts(ContactList& contacts) const noexcept override;
  /// The hand meets itself nowhere.
  WHOLEHAND_RT void selfForces(SelfForces& forces) const noexcept override;

  /// What the stops did to the hand in the last step [N or N·m].
  [[nodiscard]] const AxisEffort& stopEffort() const noexcept { return stop_effort_; }

 private:
  /// A link that stands for an axis when its contact is told: the first one the axis drives.
  struct Carrier {
    int link = 0;
    bool rotates = false;
  };

  void setJoints() noexcept;
  [[nodiscard]] AxisEffort reducedEffort(const JointEffort& torque) const noexcept;
  void holdAtStops(double period_s) noexcept;

  const HandModel* hand_;
  AnalyticScene scene_;
  Synergy synergy_;
  ArticulatedBody body_;
  std::vector<Carrier> carrier_;
  AxisPosition q_s_;
  AxisVelocity qd_s_;
  JointPosition theta_;
  JointVelocity theta_dot_;
  AxisEffort stop_effort_;
  AxisMatrix mobility_;  ///< inverse of M_r with the added masses
};

}  // namespace wholehand
