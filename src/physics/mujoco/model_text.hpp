#pragma once

#include "model/hand_model.hpp"
#include "model/scene_model.hpp"
#include "physics/mujoco/solver_settings.hpp"

#include <string>

namespace wholehand::mujoco {

/// Names by which parts are found in the compiled model.
[[nodiscard]] std::string linkName(int link);
[[nodiscard]] std::string jointName(int joint);
[[nodiscard]] std::string capsuleName(int capsule);
[[nodiscard]] std::string bodyName(int body);

/// The hand and the scene in MuJoCo's language, MJCF: a body a link with one joint, a capsule geom
/// a capsule, a body a body of the scene with its frame at the centre of mass. Fixed bodies are
/// mocap bodies: they are placed and no force moves them. Every number in full precision.
[[nodiscard]] std::string modelText(const HandModel& hand, const SceneModel& scene,
                                    const SolverSettings& settings);

}  // namespace wholehand::mujoco
