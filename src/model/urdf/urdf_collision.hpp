#pragma once

#include "model/mesh/mesh_load_time.hpp"
#include "model/scene/scene_model.hpp"
#include "model/urdf/urdf_xml.hpp"

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// The meshes of a URDF.
struct UrdfMeshes {
  std::vector<std::string> files;  ///< paths
  MeshLoadTime* time;              ///< what they may take together
};

/// Reads the shape of one `<collision>`, in its link's frame; empty, with a fault, when it is not a
/// valid collider. `key` names the element in messages. Appends the path of its mesh to
/// `meshes`. After the end of their time, meshes are not read. Internal to the URDF reader.
[[nodiscard]] std::optional<Shape> readUrdfCollision(const tinyxml2::XMLElement& collision,
                                                     const std::string& key, UrdfFaults& faults,
                                                     UrdfMeshes& meshes);

}  // namespace wholehand
