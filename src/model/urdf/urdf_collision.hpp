#pragma once

#include "model/scene_model.hpp"
#include "model/urdf/urdf_xml.hpp"

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// The shape of one `<collision>`, in its link's frame; nothing, and a fault, when it is no
/// collider. `key` names the element in messages. Internal to the URDF reader.
/// The path of a mesh that it names is appended to `mesh_files`.
[[nodiscard]] std::optional<Shape> readUrdfCollision(const tinyxml2::XMLElement& collision,
                                                     const std::string& key, UrdfFaults& faults,
                                                     std::vector<std::string>& mesh_files);

}  // namespace wholehand
