#pragma once

#include "loop/dynamics/articulated_body.hpp"
#include "loop/model/capsule_gap.hpp"
#include "loop/physics/bullet/cone_newton.hpp"
#include "loop/physics/bullet/island_newton.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"
#include "loop/physics/bullet/solver_settings.hpp"
#include "loop/physics/self_contact_search.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace wholehand::bullet {

/// A solver row that acts on the hand's reduced velocities only.
struct AxisRow {
  std::array<double, kMaxAxes> jacobian{};  ///< j
  std::array<double, kMaxAxes> response{};  ///< M_r⁻¹ j
  double effective_mass = 0.0;              ///< 1 / (j·M_r⁻¹ j); 0 disables the row
  double lacking = 0.0;                     ///< change of velocity that reaches the target
  double target = 0.0;                      ///< impulse that alone would reach it
  double impulse = 0.0;                     ///< accumulated [N·s or N·m·s]
};

/// Root L of the reduced inverse inertia: M_r⁻¹ = L Lᵀ.
using AxisRoot = InertiaRoot<kMaxAxes>;

/// Largest number of joint ends to which contacts are coupled; further ends are solved separately.
inline constexpr int kMaxCoupledEnds = 4;

/// Change of the joint ends' impulses per unit of a row's impulse.
using EndShares = std::array<double, kMaxCoupledEnds>;

/// Two capsules in contact. The force on the first and its reaction on the second act at the same
/// point: j = Gᵀ (J_a − J_b)ᵀ d. A link that carries both capsules therefore feels exactly no
/// force.
struct SelfTouch {
  int pair = -1;  ///< index into HandModel::self_contacts
  CapsuleGap gap;
  Eigen::Vector3d tangent1, tangent2;  ///< unit, world
  AxisRow normal_row, tangent1_row, tangent2_row;
};

/// Constraint rows of the hand's self-contacts and joint limits. They act in reduced velocities
/// like the contacts with bodies, so they put no load on the coupling. Real-time safe except for
/// construction.
class HandRows {
 public:
  /// @pre hand outlives this @param friction between two parts of the hand
  HandRows(const HandModel& hand, double friction, const SolverSettings& settings);

  /// Resets after the hand was placed elsewhere, at rest.
  void reset(const ArticulatedBody& at, const AxisPosition& q_s) noexcept;
  /// Finds near pairs and joint ends at the state before a step.
  void beginStep(const ArticulatedBody& at, const AxisPosition& q_s) noexcept;
  /// Builds the rows of the near pairs and joint ends. @param velocity q̇_s without contacts; @param
  /// inverse M_r⁻¹
  void setUp(const ArticulatedBody& at, const AxisMatrix& inverse, const double* velocity,
             double step_s) noexcept;
  /// Couples a contact row to the joint ends. A contact that presses a joint against its end moves
  /// the carrier of the hand, not the joint. This function therefore removes the joint from the
  /// row's response M_r⁻¹ j and returns the share of the row's impulse that the end bears. Solving
  /// contact and end in turn would need hundreds of sweeps, since the tip of a digit is much
  /// lighter than the arm.
  /// @param one_sided true: the impulse is never negative, so only ends against which it presses
  /// bear it
  void coupleToEnds(const std::array<double, kMaxAxes>& jacobian,
                    std::array<double, kMaxAxes>& response, EndShares& shares,
                    bool one_sided) const noexcept;
  /// Applies the impulses of the last step; call after the contacts have started. @param lead of
  /// the coupled ends: by how much their contacts' starting impulses exceed those of the last step
  /// @param change Δq̇_s
  void start(const EndShares& lead, double* change) noexcept;
  /// True when contacts are coupled to a joint end.
  [[nodiscard]] bool couplesEnds() const noexcept { return coupled_count_ > 0; }
  /// Impulses of the coupled ends; each contact row adds its share.
  [[nodiscard]] EndShares& coupledEndImpulse() noexcept { return coupled_impulse_; }
  /// Makes one sweep. Width as in ReducedContactSolver. @return the largest squared change of an
  /// impulse
  template <int Width>
  double iterate(double* change) noexcept;
  /// Adds a cone for each near end. @pre no self-contact and no coupled end: no end bore an impulse
  /// in the last step @return false: there is no room
  [[nodiscard]] bool addEndsTo(ConeNewton& newton, const AxisRoot& root) const noexcept;
  /// Takes the impulses of the cones that addEndsTo() added. @param row the first of their rows
  void takeEndsFrom(const ConeNewton& newton, int row) noexcept;
  /// The same for IslandNewton, in which the hand is a body of at most six unknowns.
  [[nodiscard]] bool addEndsTo(IslandNewton& newton, int slot, const AxisRoot& root) const noexcept;
  void takeEndsFrom(const IslandNewton& newton, int contact) noexcept;
  /// Stores the impulses for the next step.
  void finish() noexcept;

  [[nodiscard]] int touchCount() const noexcept { return touch_count_; }
  [[nodiscard]] const SelfTouch& touch(int i) const noexcept { return touches_[i]; }
  /// Impulse of the joint ends along each axis [N·s or N·m·s].
  [[nodiscard]] AxisEffort endImpulse() const noexcept;

 private:
  /// A joint's end. Joints driven by one axis alone share its nearest end.
  struct JointEnd {
    std::array<double, kMaxAxes> direction{};  ///< room per unit of each axis
    double room = 0.0;                         ///< distance to the end at q_s = 0 [rad]
    double left = 0.0;  ///< distance to the end at the current q_s; negative beyond it
    double kept_impulse = 0.0;
    int coupled_index = -1;  ///< index among the coupled ends, or −1
    AxisRow row;
  };
  /// Warm-start data of a touch.
  struct KeptImpulse {
    double normal = 0.0;
    Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
  };

  void addEnds(const HandModel& hand);
  void addBaseEnds(const HandModel& hand);
  void addEnd(const JointEnd& end);
  void setUpTouch(const ArticulatedBody& at, SelfTouch& touch) const noexcept;
  void finishRow(AxisRow& row, const AxisMatrix& inverse, const double* velocity,
                 double goal_velocity) const noexcept;
  [[nodiscard]] double goal(double left, double slop, double step_s) const noexcept;

  const HandModel& hand_;
  const int axes_;
  const double friction_;
  const SolverSettings settings_;
  SelfContactSearch search_;
  std::vector<SelfTouch> touches_;  ///< one per pair; the first touch_count_ are in use
  int touch_count_ = 0;
  std::vector<KeptImpulse> kept_;  ///< one per pair
  bool any_kept_ = false;
  std::vector<JointEnd> ends_;
  std::array<int, 2 * kMaxJoints> near_end_{};
  int near_end_count_ = 0;
  std::array<int, kMaxCoupledEnds> coupled_{};  ///< ends that were pressed on in the last step
  int coupled_count_ = 0;
  EndShares coupled_impulse_{};
};

}  // namespace wholehand::bullet
