#pragma once

#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Bodies whose joints move each other: joints on links that move themselves, and joints that
/// follow another one. The root stands. Its one to three coordinates q are integrated, and the
/// poses of its links follow from q, so no joint has an error. A vector or matrix over coordinates
/// has three rows; those without a coordinate are zero.
///
/// Let H = ½ q̇ᵀ M(q) q̇ + V(q), V the potential of gravity. No step adds to H more than the
/// impulses on the coordinates do (docs/adr/0095-trees-of-joints.md):
/// - An untouched tree moves by a step of Runge and Kutta (order 4), then its rates are scaled to
///   the energy that it had.
/// - A touched tree moves by T q̇'. Viscous friction adds to the inertia by which impulses change
///   q̇, M + T C. If H grew by more than the impulses' work, the rates are scaled down to it.
class JointChain {
 public:
  /// @param members bodies of the scene on joints that move each other, by ascending index, parents
  /// before the links that they carry
  JointChain(const std::vector<SceneBody>& bodies, const std::vector<int>& members);

  [[nodiscard]] int coordinates() const noexcept { return coordinates_; }
  [[nodiscard]] int links() const noexcept { return static_cast<int>(links_.size()); }
  [[nodiscard]] const Eigen::Vector3d& position() const noexcept { return q_; }
  [[nodiscard]] const Eigen::Vector3d& rate() const noexcept { return rate_; }
  /// Position of a link's joint, and its rate.
  [[nodiscard]] double jointPosition(int link) const noexcept {
    return links_[link].ratio * q_[links_[link].coordinate];
  }
  [[nodiscard]] double jointRate(int link) const noexcept {
    return links_[link].ratio * rate_[links_[link].coordinate];
  }
  /// Pose of the frame of a link's body in the world.
  [[nodiscard]] const Pose& pose(int link) const noexcept { return now_.places[link].pose; }
  /// Velocity of a link's centre of mass, and its angular velocity. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Eigen::Vector3d velocity(int link) const noexcept {
    return now_.places[link].linear * rate_;
  }
  [[nodiscard]] WHOLEHAND_RT Eigen::Vector3d spin(int link) const noexcept {
    return now_.places[link].angular * rate_;
  }
  /// Impulse on the coordinates of an impulse on a link's centre of mass and an angular one.
  /// Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Eigen::Vector3d project(
      int link, const Eigen::Vector3d& linear, const Eigen::Vector3d& angular) const noexcept {
    const Place& at = now_.places[link];
    return at.linear.transpose() * linear + at.angular.transpose() * angular;
  }

  /// Sets q and q̇ without checks. Real-time safe.
  WHOLEHAND_RT void put(const Eigen::Vector3d& q, const Eigen::Vector3d& rate) noexcept;

  /// Begins a step: computes q̇ at its end without contacts, ends of the ranges and dry friction.
  /// Real-time safe. @param touched contacts may act on a link in this step
  WHOLEHAND_RT void predict(const Eigen::Vector3d& gravity_m_s2, double step_s,
                            bool touched) noexcept;
  /// Change of q̇ per unit of impulse in this step.
  [[nodiscard]] const Eigen::Matrix3d& mobility() const noexcept { return mobility_; }
  /// Bounds of the impulses of dry friction in this step.
  [[nodiscard]] const Eigen::Vector3d& mostFriction() const noexcept { return most_friction_; }
  /// Bounds of q̇ in this step: at a bound the step ends exactly at an end of the range.
  [[nodiscard]] const Eigen::Vector3d& leastRate() const noexcept { return least_rate_; }
  [[nodiscard]] const Eigen::Vector3d& mostRate() const noexcept { return most_rate_; }
  /// True when dry friction or an end held every coordinate against gravity in this step.
  [[nodiscard]] bool loadIsHeld() const noexcept { return load_is_held_; }
  /// Ends the step with the q̇ that contacts, ends of the ranges and dry friction gave. Real-time
  /// safe.
  WHOLEHAND_RT void move(const Eigen::Vector3d& rate, double step_s) noexcept;

  /// H, with the potential of this gravity [J]. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT double energy(const Eigen::Vector3d& gravity_m_s2) const noexcept {
    return energyOf(now_, rate_, gravity_m_s2);
  }

 private:
  struct Link {
    int parent = -1;     ///< link that carries it; -1: the world
    int coordinate = 0;  ///< that its joint follows
    double ratio = 1.0;  ///< position of its joint per unit of that coordinate
    SceneJoint joint;    ///< in the frame of its body
    Pose start;          ///< in the parent's frame at q = 0
    Eigen::Vector3d com_m = Eigen::Vector3d::Zero();
    double mass_kg = 0.0;
    Eigen::Matrix3d inertia_kg_m2 = Eigen::Matrix3d::Zero();
  };
  /// A link at some q, in the world.
  struct Place {
    Pose pose;
    Eigen::Vector3d com_m, axis, point_m;  ///< axis of its joint, and a point on it
    Eigen::Matrix3d linear, angular;       ///< velocities per unit of each q̇
    /// Angular velocity, and the accelerations at q̈ = 0, at the rates of the last forces().
    Eigen::Vector3d spin, turning, pulled;
  };
  /// All links at some q.
  struct Figure {
    std::vector<Place> places;
    Eigen::Matrix3d inertia;     ///< M; 1 in rows without a coordinate
    Eigen::Vector3d first_kg_m;  ///< Σ m · centre of mass
  };
  struct Forces {
    Eigen::Vector3d weight;    ///< gravity on the coordinates
    Eigen::Vector3d inertial;  ///< forces of Coriolis and of circular motion
  };

  void addLink(const std::vector<SceneBody>& bodies, const std::vector<int>& members, int body);
  void place(const Eigen::Vector3d& q, Figure& at) const noexcept;
  [[nodiscard]] Forces forces(const Eigen::Vector3d& rate, const Eigen::Vector3d& gravity_m_s2,
                              Figure& at) const noexcept;
  [[nodiscard]] static double energyOf(const Figure& at, const Eigen::Vector3d& rate,
                                       const Eigen::Vector3d& gravity_m_s2) noexcept;
  [[nodiscard]] Eigen::Vector3d acceleration(const Eigen::Vector3d& rate, Figure& at) noexcept;
  [[nodiscard]] bool swing(const Forces& now, double step_s) noexcept;

  std::vector<Link> links_;
  int coordinates_ = 0;
  Eigen::Vector3d least_, most_;            ///< ends of the ranges
  Eigen::Vector3d viscous_, dry_friction_;  ///< of each coordinate
  Eigen::Vector3d q_, rate_;
  Figure now_, next_;  ///< at q, and at another q within a step
  // Of this step.
  Eigen::Vector3d gravity_m_s2_, next_q_;
  Eigen::Matrix3d mobility_, resistance_;  ///< (M + T C)⁻¹, and M + T C
  Eigen::Vector3d most_friction_, least_rate_, most_rate_;
  double begun_j_ = 0.0;    ///< H at its begin
  bool untouched_ = false;  ///< it keeps H
  bool load_is_held_ = false;
};

}  // namespace wholehand
