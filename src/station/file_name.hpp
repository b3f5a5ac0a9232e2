#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace wholehand {

/// Makes a part of a file name that every file system accepts: letters (of any script), digits and
/// _ stay, each run of other characters becomes one -, and at most `most_bytes` bytes of whole
/// characters are kept. Empty when no character of the text can stay.
[[nodiscard]] std::string fileNamePart(std::string_view text, std::size_t most_bytes = 60);

}  // namespace wholehand
