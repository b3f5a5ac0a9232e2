#pragma once

namespace wholehand {

/// The stiffest wall that an exercise may put on an axis, its live parameters at their upper ends:
/// what the certificate has to bear.
struct ExerciseWall {
  int axis = 0;            ///< index into DeviceModel::axes
  double stiffness = 0.0;  ///< [N/m or N·m/rad]
  double damping = 0.0;    ///< [N·s/m or N·m·s/rad]
};

}  // namespace wholehand
