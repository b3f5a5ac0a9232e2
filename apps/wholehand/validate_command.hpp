#pragma once

#include <string>
#include <vector>

namespace wholehand {

/// Checks every file and prints every fault of every file. A rendering or patient file is checked
/// against the device file of the same name where there is one, else against the shipped device it
/// fits. Returns the program's exit code.
int validateCommand(const std::vector<std::string>& files);

}  // namespace wholehand
