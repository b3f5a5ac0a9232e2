#pragma once

#include "control/transition.hpp"
#include "exercise/exercise_wall.hpp"
#include "exercise/finger_walls.hpp"
#include "model/device_model.hpp"
#include "model/toml/toml_file.hpp"

#include <vector>

namespace wholehand {

/// How far the walls' gains and their lead-in may be raised while the loop runs. The certificate is
/// asked about the walls at this ratio.
inline constexpr double kLargestWallRatio = 1.2;
inline constexpr double kLargestLeadIn_m = 0.02;

/// The table [wall] of an exercise file.
struct FingerWallFile {
  double lead_in_m = 0.0;  ///< felt so far before the fingers touch
  TransitionConfig transition;
  FingerWallConfig walls;
  AxisEffort effort_limit;  ///< of the device, per axis [N or N·m]
};

/// Reads [wall] and its [[wall.axes]]; reports what is wrong to the file. An axis that the device
/// does not have is reported by its name. Not for the tick.
[[nodiscard]] FingerWallFile readFingerWalls(TomlTable& wall, const DeviceModel& device);

/// The walls with both live ratios at their upper end: what the certificate has to bear.
/// @param stiffest, thickest how much the exercise multiplies the gains of the file at most
[[nodiscard]] std::vector<ExerciseWall> stiffestWalls(const FingerWallConfig& walls,
                                                      double stiffest = 1.0, double thickest = 1.0);

}  // namespace wholehand
