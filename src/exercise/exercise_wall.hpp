#pragma once

namespace wholehand {

/// Stiffest wall of an exercise on an axis, with its live parameters at their upper ends. Covered
/// by the certificate.
struct ExerciseWall {
  int axis = 0;            ///< index into DeviceModel::axes
  double stiffness = 0.0;  ///< [N/m or N·m/rad]
  double damping = 0.0;    ///< [N·s/m or N·m·s/rad]
};

}  // namespace wholehand
