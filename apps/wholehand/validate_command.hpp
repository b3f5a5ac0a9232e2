#pragma once

#include <string>
#include <vector>

namespace wholehand {

/// Checks files and prints every fault of each. A rendering or patient file is checked against the
/// device file of the same name, else against the shipped device that it fits. Returns the exit
/// code.
int validateCommand(const std::vector<std::string>& files);

}  // namespace wholehand
