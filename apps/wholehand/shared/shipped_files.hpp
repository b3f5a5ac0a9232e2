#pragma once

#include "loop/core/expected.hpp"
#include "rig/models.hpp"

#include <string>

namespace wholehand {

/// Path of a shipped file ("config/scenes/four-shapes.toml"): relative to the working directory,
/// else to the folders above the program. If not found, the name itself, so that the error names
/// it.
[[nodiscard]] std::string shippedFile(const std::string& relative);

/// The files of the first start, shipped.
[[nodiscard]] ModelFiles shippedModels();

/// Rendering file for a device file: the one of the same name in the folder `rendering` beside the
/// device's folder, else the shipped one, else an error.
[[nodiscard]] Expected<std::string> renderingFor(const std::string& device_file);

/// As renderingFor(), into `rendering`. On failure prints the reason, sets `code` and returns
/// false.
[[nodiscard]] bool findGains(const std::string& device, std::string& rendering, int& code);

/// File of an exercise, by name or path.
[[nodiscard]] std::string exerciseFile(const std::string& exercise);

}  // namespace wholehand
