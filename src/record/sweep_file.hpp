#pragma once

#include "loop/core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Content of a sweep file (docs/sweeps.md). Equal contents give equal bytes.
struct SweepFile {
  /// One dimension of the grid, with names or numbers as values.
  struct Axis {
    std::string name;
    std::vector<std::string> names;
    std::vector<double> numbers;
  };
  std::string trial;
  std::string digest;       ///< digest of the grid and of every file that its cells read
  std::string git_version;  ///< version of the program
  std::string grid;         ///< text of the grid
  std::vector<Axis> axes;   ///< the last axis changes fastest
  std::vector<std::string> figures;
  std::vector<std::vector<double>> values;  ///< [figure][cell]
};

/// Writes the file under a temporary name and renames it. Not real-time safe.
[[nodiscard]] Expected<Done> writeSweepFile(const SweepFile& sweep, const std::string& path);

/// Digest of an existing sweep file; an error for any other file.
[[nodiscard]] Expected<std::string> readSweepDigest(const std::string& path);

/// Values of the named figures in an existing sweep file, [figure][cell].
[[nodiscard]] Expected<std::vector<std::vector<double>>> readSweepValues(
    const std::string& path, const std::vector<std::string>& figures);

}  // namespace wholehand
