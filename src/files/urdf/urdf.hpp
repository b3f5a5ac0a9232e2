#pragma once

#include "files/urdf/urdf_visuals.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace wholehand {

class MeshLoadTime;  // files/mesh/mesh_file.hpp

/// Where a body's inertia comes from.
enum class InertiaRule {
  kIfPossible,  ///< the file, unless no such body has it: then the colliders, with a notice
  kFile,        ///< the file, however unlikely
  kColliders,   ///< the colliders at one density and the file's mass
  kRefuse       ///< the file; one that no such body has is a fault
};

/// Parts of a URDF that a body does not use.
struct UrdfUse {
  bool fixed = false;  ///< the root never moves: its inertial is not used
  InertiaRule inertia = InertiaRule::kIfPossible;
  bool friction = false;  ///< the URDF's friction is not used: the body has its own
};

/// Sum of inertials.
struct UrdfInertial {
  MassProperties sum;
  bool complete = true;  ///< false: one of them has a mass alone
};

/// One rigid body that a movable joint of a URDF carries.
struct UrdfMover {
  std::string name;  ///< name of its link
  int line = 0;      ///< line of its link in the file
  int carrier = -1;  ///< mover that carries it; -1: the root, which stands
  Pose in_carrier;   ///< pose of its link's frame in the carrier's at q = 0
  SceneJoint joint;  ///< in the frame of its link
  int follows = -1;  ///< mover whose joint its own follows: its q is ratio · the other q + offset
  double ratio = 1.0, offset = 0.0;
  std::vector<Shape> shapes;             ///< in the frame of its link
  std::vector<UrdfVisual> visuals;       ///< in the frame of its link
  std::optional<UrdfInertial> inertial;  ///< in the frame of its link
  std::optional<double> friction;        ///< as of UrdfBody
};

/// A URDF as one rigid body in the frame of its root link, and the bodies that joints connect to
/// it.
struct UrdfBody {
  std::vector<UrdfMover>
      movers;  ///< bodies on movable joints; if there are any, the root is fixed in the world
  std::vector<Shape> shapes;            ///< every collision element of every link
  std::vector<UrdfVisual> visuals;      ///< every visual of every link
  std::vector<std::string> mesh_files;  ///< paths of the meshes of its colliders
  Diagnostics notices;  ///< differences from the file, and content that is not applied
  std::optional<UrdfInertial> inertial;    ///< empty when no link has one
  bool massless = false;                   ///< links with a collider have a mass of 0
  std::vector<Eigen::Vector3d> ballast_m;  ///< centres of inertials of links without a collider
  std::optional<double> friction;          ///< from extensions of Bullet or Gazebo, 0 .. 2
};

/// Reads every `<collision>` of every link of a URDF (box, sphere, cylinder, capsule, mesh). Links
/// connected by fixed joints become one rigid body. A capsule's length is between the centres of
/// its caps. Mesh names are absolute paths or "file://" URIs. Relative names (without ".."),
/// "package://name/..." and "model://name/..." are searched for in the URDF's folder and the
/// folders above it. "%20" and backslashes are accepted. Links without a collider are frames, or
/// ballast if they have an inertial. Revolute, continuous and prismatic joints carry bodies of
/// their own; at most three that follow no other joint may move each other.
///
/// @return every fault at once, with line and element: joints of other types, more joints that move
/// each other, no collider, impossible inertials, meshes that make no collider
/// (meshCollider()), meshes that take longer than MeshLoadTime::kTotal together.
[[nodiscard]] Expected<UrdfBody> loadUrdf(const std::string& path);
/// The same; the reading time of its meshes is added to `time`.
[[nodiscard]] Expected<UrdfBody> loadUrdf(const std::string& path, MeshLoadTime& time,
                                          UrdfUse use = {});

}  // namespace wholehand
