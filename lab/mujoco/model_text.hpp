#pragma once

#include "lab/mujoco/solver_settings.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"

#include <string>

namespace wholehand::mujoco {

/// Kind (contype) of the geoms of a scene's bodies.
inline constexpr int kOfBodies = 1;

/// Names of the parts in the compiled model.
[[nodiscard]] std::string linkName(int link);
[[nodiscard]] std::string jointName(int joint);
[[nodiscard]] std::string capsuleName(int capsule);
[[nodiscard]] std::string bodyName(int body);

/// The hand and the scene in MJCF, MuJoCo's model format: each link is a body with one joint, each
/// capsule a capsule geom, each scene body a body with its frame at the centre of mass. Fixed
/// bodies are mocap bodies, which are placed and not moved by forces. Numbers have full precision.
[[nodiscard]] std::string modelText(const HandModel& hand, const SceneModel& scene,
                                    const SolverSettings& settings);

}  // namespace wholehand::mujoco
