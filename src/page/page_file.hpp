#pragma once

#include "core/expected.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>

namespace wholehand {

/// Where a template has its data: this JSON text is replaced by that of a page.
inline constexpr std::string_view kPageDataMark = "\"wholehand-page-data\"";

/// JSON as it may stand inside <script type="application/json">: in ASCII, without "<". What is no
/// UTF-8 is replaced.
[[nodiscard]] std::string embeddedJson(const nlohmann::json& data);

/// The template, read whole. Refuses one that is not there, with how it is built, and one that does
/// not have the mark exactly once.
[[nodiscard]] Expected<std::string> readPageTemplate(const std::string& template_path);

/// Writes the template with the data in it under a temporary name and renames it: the page appears
/// complete or not at all. The folder is made when only it is missing.
/// @pre page_template is of readPageTemplate()
[[nodiscard]] Expected<Done> writePage(const std::string& page_template, const nlohmann::json& data,
                                       const std::string& path);

}  // namespace wholehand
