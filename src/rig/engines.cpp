#include "rig/engines.hpp"

#include "loop/physics/bullet/bullet_world.hpp"

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
          true,
          true};
}

Diagnostic notBuiltIn(const Engine& engine) {
  return {"", 0, "--engine", engine.name, "is not built into this program", engine.remedy};
}

}  // namespace

#ifndef WHOLEHAND_LAB
std::vector<Engine> labEngines() {
  std::vector<Engine> absent;
  for (const char* name : {"mujoco", "bullet-newton", "bullet-paper", "bullet-paper-gears"}) {
    absent.push_back({name, "in the lab", {}, kLabRemedy, ""});
  }
  return absent;
}
#endif

const std::vector<Engine>& engines() {
  static const std::vector<Engine> kAll = [] {
    std::vector<Engine> all = labEngines();
    all.insert(all.begin(), bulletEngine());
    return all;
  }();
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
    if (e.name != engine) continue;
    if (!e.build) return {notBuiltIn(e)};
    if (e.persons_refused_because.empty()) continue;
    return {keyFault("", "--engine", engine,
                     "is not for real devices: " + e.persons_refused_because,
                     "use --engine " + among.front().name)};
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
    for (const Engine& e : among) {
      if (e.build) names += (names.empty() ? "" : " or ") + e.name;
    }
    return Diagnostic{"", 0, "--engine", engine, "is not a known engine", "use " + names};
  }
  if (!found->build) return notBuiltIn(*found);
  if (scene.game.slots > 0 && !found->takes_game_bodies) {
    return keyFault(scene.path, "--engine", engine, "has no slots for the bodies of a game",
                    "use --engine " + defaultEngine());
  }
  for (const SceneBody& body : scene.bodies) {
    if (!body.joint || found->takes_joints) continue;
    return keyFault(scene.path, "--engine", engine,
                    "has no joints for bodies, as \"" + body.name + "\" needs",
                    "use --engine " + defaultEngine());
  }
  return found->build(hand, scene);
}

}  // namespace wholehand
