#pragma once

#include "core/expected.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// Folders of the drivers shipped with this program: `drivers` beside it (build tree), and
/// `../lib/wholehand/drivers` (installation).
[[nodiscard]] std::vector<std::string> shippedDriverFolders();

/// The path of a driver. A name with a slash or the ending .so is a path; without a slash it is
/// relative to the working directory. Any other name is looked up in the folders in order. Refused:
/// a name in none of them; the error lists the available ones.
[[nodiscard]] Expected<std::string> findDriver(const std::string& name,
                                               const std::vector<std::string>& folders);

}  // namespace wholehand
