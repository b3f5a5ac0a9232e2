#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// The bound that an XML file exceeds, as a problem; empty: none, or the file cannot be read. It is
/// checked before parsing, because tinyxml2 compares each attribute with all others of its element
/// and the reader of URDFs compares each link with all others.
[[nodiscard]] std::string beyondUrdfBounds(const std::string& path);

/// Parses numbers independently of the locale, unlike tinyxml2's queries; empty when a word is not
/// a finite number.
[[nodiscard]] std::optional<std::vector<double>> parseNumbers(std::string text);

/// Resolves a URDF's mesh name; the unresolved path if nothing is found, so that the mesh reader's
/// message names it.
[[nodiscard]] std::filesystem::path meshPath(const std::string& name,
                                             const std::filesystem::path& urdf);

}  // namespace wholehand
