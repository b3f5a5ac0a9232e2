#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "rig/rig.hpp"

namespace wholehand {

/// Checks that contact forces do the virtual work of the driving effort and equal the felt effort:
/// means over the ticks of a hand at rest, on the person's axes.
class ContactBalance {
 public:
  /// @pre rig outlives this
  explicit ContactBalance(const Rig& rig);

  /// Adds a tick that the rig has just run. @pre kinematics are at r.theta
  void add(const TickRecord& r, const ArticulatedBody& kinematics);

  /// |Σ Gᵀ Jᵀ f + f_s|, worst axis, as a share of the largest of |f_s|, a tenth of the largest f_s
  /// in the same unit, 0.1 N or 0.01 N·m. 1 without ticks.
  [[nodiscard]] double driveError() const;
  /// |Σ Gᵀ Jᵀ f − f_coupling|, the same share of f_coupling.
  [[nodiscard]] double feltError() const;

 private:
  [[nodiscard]] AxisEffort acted(const TickRecord& r, const ArticulatedBody& kinematics) const;
  void addSelfForces(const ArticulatedBody& kinematics, AxisEffort& sum) const;
  [[nodiscard]] double share(const AxisEffort& unbalanced, const AxisEffort& reference) const;
  [[nodiscard]] double leastScale(int axis, const AxisEffort& reference) const;

  const Rig& rig_;
  AxisEffort acted_, driving_, felt_;  ///< sums
  double count_ = 0.0;
};

}  // namespace wholehand
