#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/scene_model.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// What a joint needed to be moved by a touch.
enum class TouchHelp {
  kNone,    ///< nothing
  kHeld,    ///< the other joints were held
  kCleared  ///< the other joints were held, and all other colliders were taken away
};

/// How far a touch moved a joint from its start, towards each end of its range [rad or m].
struct TouchedJoint {
  std::string body;
  bool hinge = true;
  bool follows = false;            ///< its leader was touched
  double least = 0.0, most = 0.0;  ///< the range that was asked for: an end, or one turn, or 1 m
  bool no_least = false, no_most = false;  ///< the joint has no end there
  double reached_least = 0.0, reached_most = 0.0;
  TouchHelp help = TouchHelp::kNone;
  std::string in_the_way;  ///< a body that the finger met where it got no further; empty: none
  double force_n = 0.0;    ///< largest force of a touch
  /// The largest effort on the joint that the finger's force has at any point, and the joint's dry
  /// friction [N·m or N].
  double most_effort = 0.0, dry_friction = 0.0;

  [[nodiscard]] bool moves() const;  ///< through its range, within 1 %
  /// No touch can move it: its dry friction is more than the finger's effort, or its surface is
  /// round about the axis and has no friction.
  [[nodiscard]] bool cannotMove() const;
};

/// Moves each joint of a scene's bodies through its range with one ball of a fingertip's size. The
/// ball stays at one point of the link's surface and pushes along the way of that point, with at
/// most 100 N; it rubs where no surface faces the way. Several points are tried, first in the scene
/// as it is. @return error: no joint, or a world that cannot be built
[[nodiscard]] Expected<std::vector<TouchedJoint>> touchJoints(const SceneModel& scene,
                                                              const std::string& engine);

/// Points of a shape's surface with their outward normals, in the body frame.
struct SurfacePoint {
  Eigen::Vector3d at_m, normal;
};
[[nodiscard]] std::vector<SurfacePoint> surfacePoints(const Shape& shape);

}  // namespace wholehand
