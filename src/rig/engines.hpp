#pragma once

#include "loop/core/expected.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/physics_world.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// A physics engine available to rigs.
struct Engine {
  std::string name;         ///< name in `--engine` and recordings
  std::string description;  ///< description for people
  /// Builds a world; an empty function if this program was built without the engine. @pre the hand
  /// outlives the world
  std::function<Expected<std::unique_ptr<PhysicsWorld>>(const HandModel&, const SceneModel&)> build;
  std::string remedy;                   ///< how to build the program with it
  std::string persons_refused_because;  ///< why no person may be attached; empty: allowed
  bool takes_game_bodies = false;       ///< true if its world is a BodyPool
  bool takes_joints = false;            ///< bodies may move on joints
};

/// How to build the program with the engines of lab/.
inline constexpr const char* kLabRemedy =
    "it is in the lab: configure with -DWHOLEHAND_LAB=ON (./check --full does)";
/// Engines of lab/, which defines this function. A build without the lab lists their names with
/// empty build functions.
[[nodiscard]] std::vector<Engine> labEngines();
/// All engines: the default first, the engines of the lab last.
[[nodiscard]] const std::vector<Engine>& engines();
/// Name of the default engine.
[[nodiscard]] const std::string& defaultEngine();
/// Names of all engines, including those not built in.
[[nodiscard]] std::vector<std::string> engineNames();

/// Reason why no person may be attached to that engine, or that it is not built in; empty: allowed,
/// or unknown engine.
[[nodiscard]] Diagnostics refuseForPersons(const std::string& engine,
                                           const std::vector<Engine>& among = engines());

/// Builds a world of the named engine. The error lists the names, or says how to build the engine
/// in.
[[nodiscard]] Expected<std::unique_ptr<PhysicsWorld>> buildWorld(
    const std::string& engine, const HandModel& hand, const SceneModel& scene,
    const std::vector<Engine>& among = engines());

}  // namespace wholehand
