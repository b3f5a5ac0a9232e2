#pragma once

#include "core/expected.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"
#include "physics/physics_world.hpp"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// A physics engine that a rig can be built with.
struct Engine {
  std::string name;         ///< as `--engine` takes it and recordings keep it
  std::string description;  ///< what it is, for a person
  /// Empty where this program was built without it. @pre the hand outlives the world
  std::function<Expected<std::unique_ptr<PhysicsWorld>>(const HandModel&, const SceneModel&)> build;
  std::string remedy;                ///< how a program is built with it
  std::string moves_nobody_because;  ///< why no person may be attached to it; empty: they may
};

/// Every engine there is, the default first: the one place that names them.
[[nodiscard]] const std::vector<Engine>& engines();
/// The one that runs where nobody chose.
[[nodiscard]] const std::string& defaultEngine();
/// Names of all, those that are not built in included.
[[nodiscard]] std::vector<std::string> engineNames();

/// Why no person may be attached to that engine; empty: they may, or there is none of that name.
[[nodiscard]] Diagnostics refuseForPersons(const std::string& engine,
                                           const std::vector<Engine>& among = engines());

/// A world of the engine of that name. An error says which names there are, or how to build it in.
[[nodiscard]] Expected<std::unique_ptr<PhysicsWorld>> buildWorld(
    const std::string& engine, const HandModel& hand, const SceneModel& scene,
    const std::vector<Engine>& among = engines());

}  // namespace wholehand
