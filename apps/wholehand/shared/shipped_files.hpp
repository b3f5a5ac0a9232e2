#pragma once

#include "loop/core/expected.hpp"
#include "rig/models.hpp"

#include <string>

namespace wholehand {

/// Path of a shipped file ("config/scenes/four-shapes.toml"): relative to the working directory,
/// else to the folders above the program. If it is not found, the name itself, so that the error
/// names it.
[[nodiscard]] std::string shippedFile(const std::string& relative);

/// Shipped model files of a first start.
[[nodiscard]] ModelFiles shippedModels();

/// Rendering file for a device file: the one with the same name in the folder `rendering` next to
/// the device's folder, else the shipped one, else an error.
[[nodiscard]] Expected<std::string> renderingFor(const std::string& device_file);

/// Stores the result of renderingFor() in `rendering`. On failure prints the reason, sets `code`
/// and returns false.
[[nodiscard]] bool findGains(const std::string& device, std::string& rendering, int& code);

/// File of an exercise, by name or path.
[[nodiscard]] std::string exerciseFile(const std::string& exercise);

}  // namespace wholehand
