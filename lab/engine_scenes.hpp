#pragma once

#include "experiments/grasp_trial.hpp"
#include "lab/engine_trial.hpp"
#include "rig/rig.hpp"

#include <cstdint>
#include <memory>

namespace wholehand {

/// The grasp of all scenes except kResting.
[[nodiscard]] GraspTrial comparedGrasp();
[[nodiscard]] std::uint64_t ticksOf(EngineScene scene, const EnginePlan& plan);
/// Builds and arms a rig in a scene.
[[nodiscard]] Expected<std::unique_ptr<Rig>> buildScene(EngineScene scene, const EnginePlan& plan,
                                                        const std::string& engine);

}  // namespace wholehand
