#include "assembly/engines.hpp"

#include "physics/bullet/bullet_world.hpp"
#include "physics/bullet_paper/bullet_paper_world.hpp"
#ifdef WHOLEHAND_MUJOCO
#include "physics/mujoco/mujoco_world.hpp"
#endif

#include <algorithm>

namespace wholehand {
namespace {

using World = Expected<std::unique_ptr<PhysicsWorld>>;

Engine bulletEngine() {
  return {"bullet",
          "Bullet 3.24, double precision",
          [](const HandModel& hand, const SceneModel& scene) -> World {
            return std::unique_ptr<PhysicsWorld>(std::make_unique<BulletWorld>(hand, scene));
          },
          "",
          "",
          true};
}

Engine bulletNewtonEngine() {
  return {"bullet-newton",
          "as bullet, but what the hand holds is solved by Newton's method; for comparisons",
          [](const HandModel& hand, const SceneModel& scene) -> World {
            return std::unique_ptr<PhysicsWorld>(
                std::make_unique<BulletWorld>(hand, scene, bullet::solvedAtOnce()));
          },
          "",
          "a wall that slides into the hand overlaps it more than it may",
          true};
}

Engine bulletPaperEngine() {
  return {"bullet-paper", "stock Bullet with pose resets, the paper's own way; for comparisons",
          [](const HandModel& hand, const SceneModel& scene) {
            return BulletPaperWorld::build(hand, scene);
          },
          "", "its contact forces do not do the virtual work of what is felt"};
}

Engine gearedPaperEngine() {
  return {"bullet-paper-gears", "as bullet-paper, with gear constraints instead of pose resets",
          [](const HandModel& hand, const SceneModel& scene) {
            return BulletPaperWorld::buildGeared(hand, scene);
          },
          "", "its contact forces do not do the virtual work of what is felt"};
}

Engine mujocoEngine() {
  Engine engine{"mujoco",
                "MuJoCo, Newton's method and elliptic cones",
                {},
                "install libmujoco-dev and configure with -DWHOLEHAND_MUJOCO=ON, or use bullet",
                ""};
#ifdef WHOLEHAND_MUJOCO
  engine.build = [](const HandModel& hand, const SceneModel& scene) {
    return MujocoWorld::build(hand, scene);
  };
#endif
  return engine;
}

}  // namespace

const std::vector<Engine>& engines() {
  static const std::vector<Engine> kAll{bulletEngine(), mujocoEngine(), bulletNewtonEngine(),
                                        bulletPaperEngine(), gearedPaperEngine()};
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

Diagnostics refuseForPersons(const std::string& engine, const std::vector<Engine>& among) {
  for (const Engine& e : among) {
    if (e.name != engine || e.persons_refused_because.empty()) continue;
    return {{"", 0, "--engine", engine, "is not for real devices: " + e.persons_refused_because,
             "use --engine " + among.front().name}};
  }
  return {};
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
  if (scene.game.slots > 0 && !found->takes_game_bodies) {
    return Diagnostic{scene.path,
                      0,
                      "--engine",
                      engine,
                      "has no slots for the bodies of a game",
                      "use --engine " + defaultEngine()};
  }
  return found->build(hand, scene);
}

}  // namespace wholehand
