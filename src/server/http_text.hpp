#pragma once

#include <optional>
#include <string>
#include <string_view>

// The HTTP text handling that our routes need.
namespace wholehand {

/// Value of a key in "a=1&b=2", not decoded; empty when the key is missing.
[[nodiscard]] std::string_view queryValue(std::string_view query, std::string_view key);

/// Decodes %XX in a path, once. Empty when the path is malformed or contains what no path of ours
/// does: control characters, a backslash, an empty, "." or ".." segment, an encoded slash.
[[nodiscard]] std::optional<std::string> decodedPath(std::string_view path);
/// True when a slash is encoded. It would be part of a name, and no served name contains one.
[[nodiscard]] bool hasEncodedSlash(std::string_view path);

/// Encodes a path segment: all but unreserved characters become %XX.
[[nodiscard]] std::string percentEncoded(std::string_view text);

}  // namespace wholehand
