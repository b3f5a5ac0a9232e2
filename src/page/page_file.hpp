#pragma once

#include "core/expected.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>

namespace wholehand {

/// Placeholder in a template, replaced by the page's JSON data.
inline constexpr std::string_view kPageDataMark = "\"wholehand-page-data\"";

/// JSON safe inside <script type="application/json">: ASCII, without "<". Invalid UTF-8 is
/// replaced.
[[nodiscard]] std::string embeddedJson(const nlohmann::json& data);

/// Reads a template. Refused: a missing one (the error says how it is built), and one that does not
/// have the placeholder exactly once.
[[nodiscard]] Expected<std::string> readPageTemplate(const std::string& template_path);

/// Writes the template with the data under a temporary name and renames it, so that the page
/// appears complete or not at all. Creates the folder if only it is missing.
/// @pre page_template is of readPageTemplate()
[[nodiscard]] Expected<Done> writePage(const std::string& page_template, const nlohmann::json& data,
                                       const std::string& path);

/// Packs bytes as text for JSON: zlib (RFC 1950), then base 64 (RFC 4648). Read by unpackBytes() of
/// web/src/embedded.
[[nodiscard]] std::string packBytes(std::string_view bytes);

}  // namespace wholehand
