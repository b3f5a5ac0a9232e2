#pragma once

#include <optional>
#include <string>
#include <string_view>

// The few pieces of HTTP text that our routes need.
namespace wholehand {

/// Of "a=1&b=2"; as it stands there, empty where it is missing.
[[nodiscard]] std::string_view queryValue(std::string_view query, std::string_view key);

/// A path with %XX decoded, once. Nothing where it is malformed or holds what no path of ours
/// does: control characters, a backslash, an empty, "." or ".." segment, a slash that was encoded.
[[nodiscard]] std::optional<std::string> decodedPath(std::string_view path);
/// True where a slash was encoded: it belongs to a name, and no name that is served has one.
[[nodiscard]] bool hasEncodedSlash(std::string_view path);

/// A path segment, with all but the plainest characters as %XX.
[[nodiscard]] std::string percentEncoded(std::string_view text);

}  // namespace wholehand
