#pragma once

#include "control/transition.hpp"
#include "exercise/exercise_wall.hpp"
#include "exercise/finger_walls.hpp"
#include "model/device_model.hpp"
#include "model/toml/toml_file.hpp"

#include <vector>

namespace wholehand {

/// Upper ends of the live parameters for the walls' gains and their lead-in. The certificate covers
/// the walls at this ratio.
inline constexpr double kLargestWallRatio = 1.2;
inline constexpr double kLargestLeadIn_m = 0.02;

/// The table [wall] of an exercise file.
struct FingerWallFile {
  double lead_in_m = 0.0;  ///< path over which a wall is felt before the fingers touch
  TransitionConfig transition;
  FingerWallConfig walls;
  AxisEffort effort_limit;  ///< limit of the device, per axis [N or N·m]
};

/// Reads [wall] and its [[wall.axes]]; reports faults to the file, an axis that the device lacks by
/// its name. Not real-time safe.
[[nodiscard]] FingerWallFile readFingerWalls(TomlTable& wall, const DeviceModel& device);

/// The walls with both live ratios at their upper ends, as covered by the certificate.
/// @param stiffest, thickest largest factors of the exercise on the file's gains
[[nodiscard]] std::vector<ExerciseWall> stiffestWalls(const FingerWallConfig& walls,
                                                      double stiffest = 1.0, double thickest = 1.0);

}  // namespace wholehand
