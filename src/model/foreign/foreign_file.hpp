#pragma once

#include "core/expected.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// What a file of another program is, by its first bytes and the ending of its name: problem ("is
/// ...") and remedy, the command that converts it; file and key are the caller's. Empty: not known.
/// Known are MJCF, SDF, xacro, URDF, glTF, STEP, C3D, BVH, TRC and OpenSim's MOT and STO, further
/// meshes, web pages and pointers of Git LFS.
/// @param ending "step"; in any case
[[nodiscard]] std::optional<Diagnostic> foreignFile(std::string_view head, std::string_view ending);

/// As above, of a file. Empty also when it cannot be read.
[[nodiscard]] std::optional<Diagnostic> foreignFileAt(const std::string& path);

}  // namespace wholehand
