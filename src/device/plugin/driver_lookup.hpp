#pragma once

#include "core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Where drivers that ship with this program are: `drivers` beside it (a build), and
/// `../lib/wholehand/drivers` (an installation).
[[nodiscard]] std::vector<std::string> shippedDriverFolders();

/// The path of a driver. What has a slash or ends in .so is a path already, that of the working
/// directory where it has no slash; any other name is looked up in the folders, in their order.
/// Refused: a name that is in none of them, with those that are.
[[nodiscard]] Expected<std::string> findDriver(const std::string& name,
                                               const std::vector<std::string>& folders);

}  // namespace wholehand
