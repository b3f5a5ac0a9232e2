#pragma once

#include "loop/core/expected.hpp"

#include <string>
#include <string_view>
#include <vector>

/// Writing of files that stay complete after a power cut. Not real-time safe.
namespace wholehand {

/// Calls writeDurably() and returns its error as a Diagnostic.
[[nodiscard]] Expected<Done> writeText(const std::string& path, const std::string& text);

/// Checks whether all these files can be written, including folders that do not exist yet; creates
/// nothing. Refuses two paths to one file and a path that is also an input. Empty paths are
/// skipped.
/// @param inputs files that are read during the run
[[nodiscard]] Expected<Done> checkFiles(const std::vector<std::string>& paths,
                                        const std::vector<std::string>& inputs = {});

/// Checks before a run whether all these files can be written, then creates their folders. Empty
/// paths are skipped.
[[nodiscard]] Expected<Done> prepareFiles(const std::vector<std::string>& paths);

/// Writes a file. After a return of 0 the file is complete and on the disk; after an error it is
/// either unchanged or complete. The bytes are written to a new file in the same folder, which is
/// synced and renamed to `path`; then the folder and its parent are synced. A link at `path` is
/// replaced, not followed.
/// @return an errno; 0: done
[[nodiscard]] int writeDurably(const std::string& path, std::string_view bytes);

/// Reserves an unused file name by creating an empty file: "<stem><extension>", else "<stem>-2...".
/// Programs that ask at the same time get different names. An existing link counts as a used name.
/// @param path receives the name @return an errno; 0: done
[[nodiscard]] int takeNewName(const std::string& stem, const std::string& extension,
                              std::string& path);

/// 16 random hexadecimal digits; empty when the system's random source fails.
[[nodiscard]] std::string randomName();

/// Renames a finished file of the same folder to `path` with the guarantees of writeDurably().
/// @return an errno; 0: done
[[nodiscard]] int renameDurably(const std::string& finished, const std::string& path);

/// Syncs a finished file and its folder.
/// @return an errno; 0: done
[[nodiscard]] int syncDurably(const std::string& path);

}  // namespace wholehand
