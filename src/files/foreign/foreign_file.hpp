#pragma once

#include "loop/core/expected.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace wholehand {

/// Recognises the format of a file of another program by its first bytes and its file name
/// extension. The Diagnostic holds the problem ("is ...") and the remedy, the command that converts
/// the file; the caller adds file and key. Empty: unknown format. Known formats: MJCF and its
/// parts, SDF, xacro, URDF, glTF, USD, Webots, STEP, C3D, BVH, TRC, OpenSim's MOT and STO, HDF5,
/// further meshes, web pages, and pointer files of Git LFS.
/// @param ending file name extension without the dot ("step"), in upper or lower case
[[nodiscard]] std::optional<Diagnostic> foreignFile(std::string_view head, std::string_view ending);

/// Recognises text with 2 or 4 bytes per character (UTF-16, UTF-32) by its byte order mark, or
/// because all bytes but one of each of its first 4 characters are 0. foreignFile() includes this
/// check; readers of binary formats call it separately.
[[nodiscard]] std::optional<Diagnostic> wideText(std::string_view head);

/// Calls foreignFile() with the first 4096 bytes and the extension of a file. Empty also when the
/// file cannot be read.
[[nodiscard]] std::optional<Diagnostic> foreignFileAt(const std::string& path);

}  // namespace wholehand
