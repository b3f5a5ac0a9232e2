#pragma once

#include "core/expected.hpp"

#include <string>

namespace wholehand {

/// Path of a file that comes with the program ("config/scenes/four-shapes.toml"): looked for from
/// the working directory first, then in the folders above the program itself. Where it is nowhere,
/// the name as it is, so that the error names it.
[[nodiscard]] std::string shippedFile(const std::string& relative);

/// The rendering file that goes with a device file: the one of the same name in the folder
/// `rendering` beside the device's folder; the shipped one where that does not exist; an error
/// where there is neither.
[[nodiscard]] Expected<std::string> renderingFor(const std::string& device_file);

/// The same into `rendering`; false, the reason on standard error and its exit code, where there is
/// none.
[[nodiscard]] bool findGains(const std::string& device, std::string& rendering, int& code);

/// The file of an exercise by its name or path.
[[nodiscard]] std::string exerciseFile(const std::string& exercise);

}  // namespace wholehand
