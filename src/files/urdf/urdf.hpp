#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

class MeshLoadTime;  // files/mesh/mesh_file.hpp

/// What a body does not take from a URDF.
struct UrdfUse {
  bool fixed = false;            ///< no inertial of the root: it never moves
  bool uniform_density = false;  ///< inertials but their masses
  bool friction = false;         ///< no friction: the body has its own
};

/// What a movable joint of a URDF carries: one rigid body.
struct UrdfMover {
  std::string name;                        ///< of its link
  int line = 0;                            ///< of its link
  Pose in_root;                            ///< of its link's frame, in the root link's, at q = 0
  SceneJoint joint;                        ///< in the frame of its link
  std::vector<Shape> shapes;               ///< in the frame of its link
  std::optional<MassProperties> inertial;  ///< the same
};

/// A URDF as one rigid body, in the frame of its root link, and what moves on joints to it.
struct UrdfBody {
  std::vector<UrdfMover> movers;           ///< then the root stands in the world
  std::vector<Shape> shapes;               ///< every collision element of every link
  std::vector<std::string> mesh_files;     ///< paths of the meshes it names
  Diagnostics notices;                     ///< what differs from the file, or is not applied
  std::optional<MassProperties> inertial;  ///< sum of the inertials; empty when no link has one
  std::vector<Eigen::Vector3d> ballast_m;  ///< centres of inertials of links without a collider
  std::optional<double> friction;          ///< of extensions of Bullet or Gazebo, 0 .. 2
};

/// Reads every `<collision>` of every link of a URDF (box, sphere, cylinder, capsule, mesh).
/// Links connected by fixed joints become one rigid body. A capsule's length is between the centres
/// of its caps. Mesh names are absolute or "file://", or, searched for in the URDF's folder and
/// those above it, relative (without ".."), "package://name/..." or "model://name/..."; with "%20"
/// or backslashes, too. Links without a collider are frames; with an inertial, ballast. Revolute,
/// continuous and prismatic joints at the root body carry bodies of their own.
///
/// @return every fault at once, with line and element: joints of other types, joints at what
/// another joint carries, no collider, impossible
/// inertials, meshes that make no collider (meshCollider()), meshes that take longer than
/// MeshLoadTime::kTotal together.
[[nodiscard]] Expected<UrdfBody> loadUrdf(const std::string& path);
/// As above; the time of its meshes is added to `time`.
[[nodiscard]] Expected<UrdfBody> loadUrdf(const std::string& path, MeshLoadTime& time,
                                          UrdfUse use = {});

}  // namespace wholehand
