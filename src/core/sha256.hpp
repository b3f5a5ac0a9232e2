#pragma once

#include <string>
#include <string_view>

namespace wholehand {

/// SHA-256 (FIPS 180-4, by OpenSSL) as 64 hexadecimal digits.
[[nodiscard]] std::string sha256(std::string_view bytes);

}  // namespace wholehand
