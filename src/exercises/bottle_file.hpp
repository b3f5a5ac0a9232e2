#pragma once

#include "files/toml/toml_file.hpp"
#include "loop/exercise/finger_cushions.hpp"

namespace wholehand {

/// Reads [bottle] without its liquid; reports faults to the file. Not real-time safe.
[[nodiscard]] Bottle readBottle(TomlTable& table);

/// Returns the bottle filled with the table's liquid (viscosity_pa_s). Reports a liquid whose
/// resistance is too small to be perceived. Not real-time safe.
[[nodiscard]] Bottle readLiquid(TomlTable& table, Bottle bottle);

}  // namespace wholehand
