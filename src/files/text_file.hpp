#pragma once

#include "core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Writes a file that is whole and on the disk when this returns, or unchanged:
/// files/durable_file.hpp.
[[nodiscard]] Expected<Done> writeText(const std::string& path, const std::string& text);

/// Checks whether all these files can be written, including folders that do not exist yet; creates
/// nothing. Refused: two paths to one file, and a path that is also an input. Empty paths are
/// skipped.
/// @param inputs files that are read meanwhile
[[nodiscard]] Expected<Done> checkFiles(const std::vector<std::string>& paths,
                                        const std::vector<std::string>& inputs = {});

/// Checks before a run whether all these files can be written, then creates their folders. Empty
/// paths are skipped.
[[nodiscard]] Expected<Done> prepareFiles(const std::vector<std::string>& paths);

}  // namespace wholehand
