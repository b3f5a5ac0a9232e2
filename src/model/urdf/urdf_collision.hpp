#pragma once

#include "model/scene/scene_model.hpp"
#include "model/urdf/urdf_xml.hpp"

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Reads the shape of one `<collision>`, in its link's frame; empty, with a fault, when it is not a
/// valid collider. `key` names the element in messages. Appends the path of its mesh to
/// `mesh_files`. Internal to the URDF reader.
[[nodiscard]] std::optional<Shape> readUrdfCollision(const tinyxml2::XMLElement& collision,
                                                     const std::string& key, UrdfFaults& faults,
                                                     std::vector<std::string>& mesh_files);

}  // namespace wholehand
