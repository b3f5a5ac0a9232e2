#pragma once

#include "loop/core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// What a sweep writes (docs/sweeps.md). Same contents, same bytes.
struct SweepFile {
  /// One dimension; names or numbers.
  struct Axis {
    std::string name;
    std::vector<std::string> names;
    std::vector<double> numbers;
  };
  std::string trial;
  std::string digest;       ///< of the grid and of every file that its cells read
  std::string git_version;  ///< of the program
  std::string grid;         ///< text of the grid
  std::vector<Axis> axes;   ///< the last changes fastest
  std::vector<std::string> figures;
  std::vector<std::vector<double>> values;  ///< [figure][cell]
};

/// Writes the file under a temporary name and renames it. Not for the tick.
[[nodiscard]] Expected<Done> writeSweepFile(const SweepFile& sweep, const std::string& path);

/// Digest of an existing sweep file. Refused: a file that is none.
[[nodiscard]] Expected<std::string> readSweepDigest(const std::string& path);

/// Values of an existing sweep file, [figure][cell], by the figures named.
[[nodiscard]] Expected<std::vector<std::vector<double>>> readSweepValues(
    const std::string& path, const std::vector<std::string>& figures);

}  // namespace wholehand
