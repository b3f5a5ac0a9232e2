#pragma once

#include "files/toml/toml_file.hpp"
#include "loop/control/transition.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/exercise/finger_walls.hpp"
#include "loop/model/device_model.hpp"

namespace wholehand {

/// The table [wall] of an exercise file.
struct FingerWallFile {
  double lead_in_m = 0.0;  ///< distance before contact over which the wall is already rendered
  TransitionConfig transition;
  FingerWallConfig walls;
  AxisEffort effort_limit;  ///< limit of the device, per axis [N or N·m]
};

/// Reads [wall] and its [[wall.axes]] and reports faults to the file. An axis that the device lacks
/// is reported by name. Not real-time safe.
[[nodiscard]] FingerWallFile readFingerWalls(TomlTable& wall, const DeviceModel& device);

}  // namespace wholehand
