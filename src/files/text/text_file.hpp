#pragma once

#include "loop/core/expected.hpp"

#include <string>
#include <string_view>
#include <vector>

/// Files that a power cut leaves whole. Not real-time safe.
namespace wholehand {

/// As writeDurably(), with its error as a Diagnostic.
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

/// Writes a file. When it returns 0, the file is whole and on the disk; otherwise it is as it was,
/// or whole. The bytes go to a new file beside it, which is synced, takes the name, and then the
/// folder and its parent are synced. A link at `path` is replaced, not followed.
/// @return an errno; 0: done
[[nodiscard]] int writeDurably(const std::string& path, std::string_view bytes);

/// Takes a name that no file has, by creating it empty: "<stem><extension>", else "<stem>-2...". Of
/// several programs that ask at once, each gets a name of its own. A link is a name that is taken.
/// @param path the name @return an errno; 0: done
[[nodiscard]] int takeNewName(const std::string& stem, const std::string& extension,
                              std::string& path);

/// 16 hexadecimal digits that nobody can guess; empty where the system gives none.
[[nodiscard]] std::string randomName();

/// Gives a finished file, in the same folder, its name: as above.
/// @return an errno; 0: done
[[nodiscard]] int renameDurably(const std::string& finished, const std::string& path);

/// Syncs a finished file, and the folder that has its name.
/// @return an errno; 0: done
[[nodiscard]] int syncDurably(const std::string& path);

}  // namespace wholehand
