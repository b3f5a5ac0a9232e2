#pragma once

#include "files/toml/toml_file.hpp"
#include "loop/exercise/finger_cushions.hpp"

namespace wholehand {

/// Reads [bottle], without its liquid; reports faults to the file. Not real-time safe.
[[nodiscard]] Bottle readBottle(TomlTable& table);

/// The bottle filled with a table's liquid, viscosity_pa_s; reports one that is not felt. Not
/// real-time safe.
[[nodiscard]] Bottle readLiquid(TomlTable& table, Bottle bottle);

}  // namespace wholehand
