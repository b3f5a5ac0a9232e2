#pragma once

#include <string>

// File names of a recording's parts. Private to telemetry.
namespace wholehand::recording {

/// Limit of parts, so that a failing disk does not fill a folder with files.
inline constexpr int kMostParts = 99;

/// "a/run.h5", 2: "a/run.part2.h5".
[[nodiscard]] std::string partPath(const std::string& path, int part);

/// Reason why an existing file must not be replaced by a new recording; empty: it may be.
[[nodiscard]] std::string reasonNotToReplace(const std::string& path);

/// Removes the parts after the first, except those with a reasonNotToReplace().
void removeParts(const std::string& path);

}  // namespace wholehand::recording
