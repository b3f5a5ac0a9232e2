#pragma once

#include <filesystem>

namespace wholehand {

/// `wholehand doctor`: examines this machine, runs a periodic loop for three seconds and prints
/// findings with remedies to standard output. Colours only on a terminal, and not when NO_COLOR is
/// set. Takes about 3 s; the last line is the verdict.
/// @param packages_file the list of Debian packages, scripts/packages.txt
/// @return the exit code: 0 when this machine may drive a device, else 1
int runDoctor(const std::filesystem::path& packages_file);

}  // namespace wholehand
