#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// By the name's ending; "application/octet-stream" where it is not known.
[[nodiscard]] const char* mimeType(std::string_view path);

/// Whether the bundler put a hash of the content into the name ("assets/main-B2xk9_aQ.js"): such a
/// file never changes.
[[nodiscard]] bool nameHasHash(std::string_view path);

/// A file of a folder, by a decoded path ("/assets/a.js"; a folder stands for its index.html).
/// Nothing where there is none, where a segment begins with a dot, or where it lies outside the
/// folder (a link out of it).
[[nodiscard]] std::optional<std::string> fileWithin(const std::string& folder,
                                                    std::string_view path);

/// Changes when the file does: from its size and time.
[[nodiscard]] std::string entityTag(const std::string& file);

}  // namespace wholehand
