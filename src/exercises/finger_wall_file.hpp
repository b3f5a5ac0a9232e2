#pragma once

#include "files/toml/toml_file.hpp"
#include "loop/control/transition.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/exercise/finger_walls.hpp"
#include "loop/model/device_model.hpp"

namespace wholehand {

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

}  // namespace wholehand
