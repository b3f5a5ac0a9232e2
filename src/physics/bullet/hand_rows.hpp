#pragma once

#include "dynamics/articulated_body.hpp"
#include "physics/bullet/solver_settings.hpp"
#include "physics/self_contact_search.hpp"

#include <Eigen/Core>

#include <array>
#include <vector>

namespace wholehand::bullet {

/// A row of the solver that acts on the hand's reduced velocities alone.
struct AxisRow {
  std::array<double, kMaxAxes> jacobian{};  ///< j
  std::array<double, kMaxAxes> response{};  ///< M_r⁻¹ j
  double effective_mass = 0.0;              ///< 1 / (j·M_r⁻¹ j); 0 switches the row off
  double target = 0.0;                      ///< impulse that alone would reach the goal velocity
  double impulse = 0.0;                     ///< accumulated [N·s or N·m·s]
};

/// The most joint ends that contacts may lean on at once; further ones are solved beside them.
inline constexpr int kMaxLeaning = 4;

/// What a unit of a row's impulse adds to the impulses of the ends that bear it.
using Lean = std::array<double, kMaxLeaning>;

/// Two capsules that meet. The force on the first acts at the same point as its reaction on the
/// second: j = Gᵀ (J_a − J_b)ᵀ d, and what carries both feels exactly nothing.
struct SelfTouch {
  int pair = -1;  ///< index into HandModel::self_contacts
  CapsuleGap gap;
  Eigen::Vector3d tangent1, tangent2;  ///< unit, world
  AxisRow normal_row, tangent1_row, tangent2_row;
};

/// The rows of a hand with itself: capsules that stop each other, and joints at their ends.
/// Everything acts in reduced velocities, as the contacts with bodies do, so nothing loads the
/// coupling. Real-time safe but for construction.
class HandRows {
 public:
  /// @pre hand outlives this @param friction between two parts of the hand
  HandRows(const HandModel& hand, double friction, const SolverSettings& settings);

  /// The hand was put elsewhere, at rest.
  void reset(const ArticulatedBody& at, const AxisPosition& q_s) noexcept;
  /// What is near at the state before a step.
  void beginStep(const ArticulatedBody& at, const AxisPosition& q_s) noexcept;
  /// Rows from what is near. @param velocity q̇_s without contacts; @param inverse M_r⁻¹
  void setUp(const ArticulatedBody& at, const AxisMatrix& inverse, const double* velocity,
             double step_s) noexcept;
  /// A contact that presses a joint against its end moves what carries the hand, not the joint:
  /// takes the joint out of the row's response M_r⁻¹ j, and says what of the row's impulse the end
  /// bears. Solving contact and end in turns would take hundreds of sweeps: the tip of a digit is
  /// much lighter than the arm.
  /// @param one_sided the impulse is never negative; only ends that it presses upon then bear it
  void lean(const std::array<double, kMaxAxes>& jacobian, std::array<double, kMaxAxes>& response,
            Lean& lean, bool one_sided) const noexcept;
  /// After the contacts have started: the impulses of the last step. `change` is Δq̇_s.
  void start(double* change) noexcept;
  /// Whether there are joint ends that contacts may lean on.
  [[nodiscard]] bool leaning() const noexcept { return leaning_count_ > 0; }
  /// Impulses of the ends that contacts lean on; a row that leans adds its share.
  [[nodiscard]] Lean& leaningImpulse() noexcept { return leaning_impulse_; }
  /// One sweep. Width as in ReducedContactSolver. @return the largest squared change of an impulse
  template <int Width>
  double iterate(double* change) noexcept;
  /// Keeps the impulses for the next step.
  void finish() noexcept;

  [[nodiscard]] int touchCount() const noexcept { return touch_count_; }
  [[nodiscard]] const SelfTouch& touch(int i) const noexcept { return touches_[i]; }
  /// Impulse of the joint ends along each axis [N·s or N·m·s].
  [[nodiscard]] AxisEffort endImpulse() const noexcept;

 private:
  /// A joint's end. Joints that one axis drives alone share its nearest end.
  struct JointEnd {
    std::array<double, kMaxAxes> way{};  ///< room grows by this per unit of each axis
    double room = 0.0;                   ///< at q_s = 0 [rad]
    double left = 0.0;                   ///< at the present q_s; negative beyond the end
    double kept_impulse = 0.0;
    int leaning = -1;  ///< its place among those, or −1
    AxisRow row;
  };
  /// What a touch starts from.
  struct Kept {
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
  std::vector<SelfTouch> touches_;  ///< as many as pairs; the first touch_count_ are in use
  int touch_count_ = 0;
  std::vector<Kept> kept_;  ///< of every pair
  bool any_kept_ = false;
  std::vector<JointEnd> ends_;
  std::array<int, 2 * kMaxJoints> near_end_{};
  int near_end_count_ = 0;
  std::array<int, kMaxLeaning> leaning_{};  ///< ends that were pressed upon in the last step
  int leaning_count_ = 0;
  Lean leaning_impulse_{};
};

}  // namespace wholehand::bullet
