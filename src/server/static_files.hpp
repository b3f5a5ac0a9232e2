#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// MIME type by file extension; "application/octet-stream" when unknown.
[[nodiscard]] const char* mimeType(std::string_view path);

/// True when the bundler put a content hash into the name ("assets/main-B2xk9_aQ.js"). Such a file
/// never changes.
[[nodiscard]] bool nameHasHash(std::string_view path);

/// Full path of a file within a folder, from a decoded path ("/assets/a.js"; a folder stands for
/// its index.html). Empty when there is none, when a segment begins with a dot, or when a symbolic
/// link leads out of the folder.
[[nodiscard]] std::optional<std::string> fileWithin(const std::string& folder,
                                                    std::string_view path);

/// Entity tag from the file's size and modification time.
[[nodiscard]] std::string entityTag(const std::string& file);

}  // namespace wholehand
