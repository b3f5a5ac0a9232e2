#include "assembly/engines.hpp"

#include "physics/bullet/bullet_world.hpp"
#ifdef WHOLEHAND_MUJOCO
#include "physics/mujoco/mujoco_world.hpp"
#endif

#include <algorithm>

namespace wholehand {
namespace {

using World = Expected<std::unique_ptr<PhysicsWorld>>;

Engine bulletEngine() {
  return {"bullet", "Bullet 3.24, double precision",
          [](const HandModel& hand, const SceneModel& scene) -> World {
            return std::unique_ptr<PhysicsWorld>(std::make_unique<BulletWorld>(hand, scene));
          },
          ""};
}

Engine mujocoEngine() {
  Engine engine{"mujoco",
                "MuJoCo, Newton's method and elliptic cones",
                {},
                "install libmujoco-dev and configure with -DWHOLEHAND_MUJOCO=ON, or use bullet"};
#ifdef WHOLEHAND_MUJOCO
  engine.build = [](const HandModel& hand, const SceneModel& scene) {
    return MujocoWorld::build(hand, scene);
  };
#endif
  return engine;
}

}  // namespace

const std::vector<Engine>& engines() {
  static const std::vector<Engine> kAll{bulletEngine(), mujocoEngine()};
  return kAll;
}

const std::string& defaultEngine() {
  return engines().front().name;
}

std::vector<std::string> engineNames() {
  std::vector<std::string> names;
  for (const Engine& engine : engines()) names.push_back(engine.name);
  return names;
}

Expected<std::unique_ptr<PhysicsWorld>> buildWorld(const std::string& engine, const HandModel& hand,
                                                   const SceneModel& scene,
                                                   const std::vector<Engine>& among) {
  const auto found =
      std::find_if(among.begin(), among.end(), [&](const Engine& e) { return e.name == engine; });
  if (found == among.end()) {
    std::string names;
    for (const Engine& e : among) names += (names.empty() ? "" : " or ") + e.name;
    return Diagnostic{"", 0, "--engine", engine, "is not a known engine", "use " + names};
  }
  if (!found->build) {
    return Diagnostic{"", 0, "--engine", engine, "is not built into this program", found->remedy};
  }
  return found->build(hand, scene);
}

}  // namespace wholehand
