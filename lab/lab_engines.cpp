#include "lab/bullet_paper/bullet_paper_world.hpp"
#include "lab/mujoco/mujoco_world.hpp"
#include "loop/physics/bullet/bullet_world.hpp"
#include "rig/engines.hpp"

namespace wholehand {
namespace {

using World = Expected<std::unique_ptr<PhysicsWorld>>;

/// Settings with Newton's method instead of the hand's sweeps; its impulses decay more slowly (ADR
/// 39).
bullet::SolverSettings solvedAtOnce() {
  bullet::SolverSettings settings;
  settings.at_once = true;
  settings.warm_start = settings.wall_warm_start = 0.998;
  return settings;
}

Engine bulletNewtonEngine() {
  return {"bullet-newton",
          "as bullet, but what the hand holds is solved by Newton's method; for comparisons",
          [](const HandModel& hand, const SceneModel& scene) -> World {
            return std::unique_ptr<PhysicsWorld>(
                std::make_unique<BulletWorld>(hand, scene, solvedAtOnce()));
          },
          "",
          "a wall that slides into the hand overlaps it more than it may",
          true,
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
  return {"mujoco", "MuJoCo, Newton's method and elliptic cones",
          [](const HandModel& hand, const SceneModel& scene) {
            return MujocoWorld::build(hand, scene);
          },
          "", ""};
}

}  // namespace

std::vector<Engine> labEngines() {
  return {mujocoEngine(), bulletNewtonEngine(), bulletPaperEngine(), gearedPaperEngine()};
}

}  // namespace wholehand
