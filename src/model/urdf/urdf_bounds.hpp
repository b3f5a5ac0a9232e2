#pragma once

#include <string>

namespace wholehand {

/// The bound that an XML file exceeds, as a problem; empty: none, or the file cannot be read.
/// Checked before it is parsed: tinyxml2 compares each attribute with all others of its element,
/// and the reader each link with all others.
[[nodiscard]] std::string beyondUrdfBounds(const std::string& path);

}  // namespace wholehand
