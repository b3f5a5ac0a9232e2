#pragma once

#include <filesystem>

namespace wholehand {

/// `wholehand doctor`: looks at this machine, wakes a loop up for two seconds and prints to
/// standard output what is well, what is not and the remedy of each. Colour only on a terminal,
/// and not where NO_COLOR is set. Takes about 2 s.
/// @param packages_file the list of Debian packages, scripts/packages.txt
/// @return the exit code of the program: 0, whatever it finds
int runDoctor(const std::filesystem::path& packages_file);

}  // namespace wholehand
