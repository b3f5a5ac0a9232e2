#pragma once

#include "files/toml/toml_file.hpp"
#include "loop/exercise/finger_cushions.hpp"
#include "loop/model/scene_model.hpp"

#include <string>

namespace wholehand {

/// Reads [bottle] without its liquid; reports faults to the file. Not real-time safe.
[[nodiscard]] Bottle readBottle(TomlTable& table);

/// Returns the bottle filled with the table's liquid (viscosity_pa_s). Reports a liquid whose
/// resistance is too small to be perceived. Not real-time safe.
[[nodiscard]] Bottle readLiquid(TomlTable& table, Bottle bottle);

/// Index of the named body if it is one upright cylinder, and fixed if it must be; otherwise
/// reports it at `key` and returns -1. Not real-time safe.
[[nodiscard]] int uprightCylinder(TomlTable& table, const char* key, const std::string& name,
                                  const SceneModel& scene, bool fixed);

}  // namespace wholehand
