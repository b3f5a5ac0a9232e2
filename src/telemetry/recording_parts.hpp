#pragma once

#include <string>

// Names and fate of the files of a recording. Private to telemetry.
namespace wholehand::recording {

/// A disk that refuses writes again and again does not fill a folder with files.
inline constexpr int kMostParts = 99;

/// "a/run.h5", 2: "a/run.part2.h5".
[[nodiscard]] std::string partPath(const std::string& path, int part);

/// Why what is there may not give way to a new recording; empty where it may.
[[nodiscard]] std::string irreplaceable(const std::string& path);

/// Removes the parts after the first, but what may not give way.
void removeParts(const std::string& path);

}  // namespace wholehand::recording
