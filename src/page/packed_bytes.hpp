#pragma once

#include <string>
#include <string_view>

namespace wholehand {

/// Packs bytes as text for JSON: zlib (RFC 1950), then base 64 (RFC 4648). Read by unpackBytes() of
/// web/src/embedded.
[[nodiscard]] std::string packBytes(std::string_view bytes);

}  // namespace wholehand
