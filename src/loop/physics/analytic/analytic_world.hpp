#pragma once

#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/physics/physics_world.hpp"

#include <limits>
#include <vector>

namespace wholehand {

/// Environment of the hand along one reduced coordinate. Units follow the axis.
struct AnalyticAxis {
  double lower_stop = -std::numeric_limits<double>::infinity();  ///< rigid [m or rad]
  double upper_stop = std::numeric_limits<double>::infinity();   ///< rigid [m or rad]
  double stiffness = 0.0;    ///< stiffness of a spring towards spring_rest [N/m or N·m/rad], >= 0
  double damping = 0.0;      ///< viscous damping against the world [N·s/m or N·m·s/rad], >= 0
  double spring_rest = 0.0;  ///< [m or rad]
  double added_mass = 0.0;  ///< mass that moves with the axis, without weight [kg or kg·m²], >= 0
};

struct AnalyticScene {
  Eigen::Vector3d gravity_m_s2{0.0, 0.0, -9.81};
  std::vector<AnalyticAxis> axes;  ///< in the device's order; missing ones are free
};

/// A world without bodies and with closed-form dynamics. The hand in reduced coordinates, M_r q̈_s
/// = Gᵀτ − h_r + springs, is integrated by symplectic Euler as in the engines. Rigid stops act on
/// velocities like a contact solver: no stop is penetrated after a step, and the effort of each
/// stop is reported as one contact (capsule and body -1).
class AnalyticWorld final : public PhysicsWorld {
 public:
  /// @pre hand outlives this
  AnalyticWorld(const HandModel& hand, AnalyticScene scene);

  [[nodiscard]] Expected<Done> placeHand(const AxisPosition& q_s) override;
  [[nodiscard]] WHOLEHAND_RT Fault observe(PhysicsState& state) noexcept override;
  /// Does nothing: this world has no bodies.
  WHOLEHAND_RT void placeBodies(const BodyPlacements& placements) noexcept override;
  [[nodiscard]] WHOLEHAND_RT Fault step(const HandDrive& drive, double period_s) noexcept override;
  WHOLEHAND_RT void contacts(ContactList& contacts) const noexcept override;
  /// Reports none: this world has no self-contact.
  WHOLEHAND_RT void selfForces(SelfForces& forces) const noexcept override;

  /// Effort of the stops on the hand in the last step [N or N·m].
  [[nodiscard]] const AxisEffort& stopEffort() const noexcept { return stop_effort_; }

 private:
  /// Link that represents an axis in reported contacts: the first one that the axis drives.
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
  AxisMatrix mobility_;  ///< inverse of M_r with added masses
};

}  // namespace wholehand
