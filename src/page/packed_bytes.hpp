#pragma once

#include <string>
#include <string_view>

namespace wholehand {

/// Bytes as text for JSON: compressed by zlib (RFC 1950), then base 64 (RFC 4648).
/// unpackBytes() of web/src/embedded reads it.
[[nodiscard]] std::string packBytes(std::string_view bytes);

}  // namespace wholehand
