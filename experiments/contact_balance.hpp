#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "rig/rig.hpp"

namespace wholehand {

/// Checks that the contact forces do the virtual work of the driving effort and equal the rendered
/// effort. Compares means over the ticks of a hand at rest, on the person's axes.
class ContactBalance {
 public:
  /// @pre rig outlives this
  explicit ContactBalance(const Rig& rig);

  /// Adds the tick that the rig has just run. @pre kinematics are at r.theta
  void add(const TickRecord& r, const ArticulatedBody& kinematics);

  /// |Σ Gᵀ Jᵀ f + f_s| of the worst axis, relative to the largest of |f_s|, a tenth of the largest
  /// f_s in the same unit, and 0.1 N or 0.01 N·m. 1 without ticks.
  [[nodiscard]] double driveError() const;
  /// |Σ Gᵀ Jᵀ f − f_coupling|, relative to f_coupling in the same way.
  [[nodiscard]] double feltError() const;

 private:
  [[nodiscard]] AxisEffort acted(const TickRecord& r, const ArticulatedBody& kinematics) const;
  void addSelfForces(const ArticulatedBody& kinematics, AxisEffort& sum) const;
  [[nodiscard]] double share(const AxisEffort& unbalanced, const AxisEffort& reference) const;
  [[nodiscard]] double leastScale(int axis, const AxisEffort& reference) const;

  const Rig& rig_;
  AxisEffort acted_, driving_, felt_;  ///< sums over the ticks
  double count_ = 0.0;
};

}  // namespace wholehand
