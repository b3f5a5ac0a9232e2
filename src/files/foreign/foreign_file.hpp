#pragma once

#include "loop/core/expected.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// What a file of another program is, by its first bytes and the ending of its name: problem ("is
/// ...") and remedy, the command that converts it; file and key are the caller's. Empty: not known.
/// Known are MJCF, SDF, xacro, URDF, glTF, USD, Webots, STEP, C3D, BVH, TRC and OpenSim's MOT and
/// STO, further meshes, web pages and pointers of Git LFS.
/// @param ending "step"; in any case
[[nodiscard]] std::optional<Diagnostic> foreignFile(std::string_view head, std::string_view ending);

/// A text of characters of 2 or 4 bytes: by its byte order mark, or because all but one byte of its
/// first characters are 0. Part of the above; also to be asked of what may be read as binary.
[[nodiscard]] std::optional<Diagnostic> wideText(std::string_view head);

/// As foreignFile(), of a file. Empty also when it cannot be read.
[[nodiscard]] std::optional<Diagnostic> foreignFileAt(const std::string& path);

}  // namespace wholehand
