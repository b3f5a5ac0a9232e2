#pragma once

#include "files/urdf/urdf.hpp"
#include "loop/core/expected.hpp"

#include <string>

namespace wholehand {

/// True for a file that is a URDF by its content, or by its name if its content is of no known
/// kind.
[[nodiscard]] bool isUrdf(const std::string& path);

/// A scene with one object, made of its URDF.
struct ObjectScene {
  std::string text;   ///< the scene file, which names the URDF as a file of its own folder
  Diagnostic notice;  ///< says where the object is
};

/// Makes a scene that puts an object before the hand: its nearest face some centimetres before the
/// fingertips, turned by quarters of a turn so that it opens towards the person. What stands has
/// the middle of its moving parts at the height of the hand; what moves freely stands on a table.
[[nodiscard]] ObjectScene makeObjectScene(const std::string& path, const UrdfBody& urdf);

}  // namespace wholehand
