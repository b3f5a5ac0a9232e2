#pragma once

#include "core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Writes a file through a temporary one beside it; nothing half-written.
[[nodiscard]] Expected<Done> writeText(const std::string& path, const std::string& text);

/// Finds out whether all these files can be written, folders that are still to be made included;
/// makes nothing. Two of them that are one file, by whatever names, and one that is among what is
/// read are refused. Empty paths are passed over.
/// @param inputs files that are read meanwhile
[[nodiscard]] Expected<Done> checkFiles(const std::vector<std::string>& paths,
                                        const std::vector<std::string>& inputs = {});

/// Finds out before a run, not after it, whether all these files can be written; then makes their
/// folders. Empty paths are passed over.
[[nodiscard]] Expected<Done> prepareFiles(const std::vector<std::string>& paths);

}  // namespace wholehand
