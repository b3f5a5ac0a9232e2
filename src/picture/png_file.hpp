#pragma once

#include "core/expected.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// Writes an 8-bit sRGB picture, rows from the top, three bytes a pixel. The file appears whole or
/// not at all: it is written beside its place and renamed. An unwritable path is a Diagnostic.
/// @pre rgb.size() == 3 * width_px * height_px
[[nodiscard]] Expected<Done> writePng(const std::string& path, int width_px, int height_px,
                                      const std::vector<std::uint8_t>& rgb);

}  // namespace wholehand
