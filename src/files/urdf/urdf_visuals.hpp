#pragma once

#include "loop/core/geometry.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace wholehand {

class MeshLoadTime;  // files/mesh/mesh_file.hpp

/// What a <visual> of a URDF shows. It says where else the mass of a body may lie.
struct UrdfVisual {
  Pose in_body;
  std::string mesh;  ///< path; empty: a box, ball, cylinder or capsule
  /// Half of the box around it [m]; of a mesh, its scale.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
};

/// The visuals of a link, in its frame. What cannot be read is left out, since nothing of it is
/// simulated. @param urdf path of the file
[[nodiscard]] std::vector<UrdfVisual> readVisuals(const tinyxml2::XMLElement& link,
                                                  const std::string& urdf);

/// Points whose hull contains the visuals, in the body's frame [m]. Meshes that cannot be read
/// have none. Adds the paths of those that can to `files`, and their reading time to `time`.
[[nodiscard]] std::vector<Eigen::Vector3d> pointsOf(const std::vector<UrdfVisual>& visuals,
                                                    MeshLoadTime& time,
                                                    std::vector<std::string>& files);

}  // namespace wholehand
