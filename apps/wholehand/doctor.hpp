#pragma once

#include <filesystem>

namespace wholehand {

/// `wholehand doctor`: looks at this machine, wakes a loop up for three seconds and prints to
/// standard output what is well, what is not and the remedy of each. Colour only on a terminal,
/// and not where NO_COLOR is set. Takes about 3 s; the last line is the verdict.
/// @param packages_file the list of Debian packages, scripts/packages.txt
/// @return the exit code of the program: 0 where this machine may drive a device, 1 where not
int runDoctor(const std::filesystem::path& packages_file);

}  // namespace wholehand
