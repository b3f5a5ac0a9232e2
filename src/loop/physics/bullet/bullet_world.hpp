#pragma once

#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/bullet/solver_settings.hpp"
#include "loop/physics/physics_world.hpp"

#include <memory>

namespace wholehand::bullet {

/// Makes Bullet's allocations throw std::bad_alloc when no memory is left; Bullet's own allocator
/// then writes to address 0. Applies to the whole process; call before the first Bullet object is
/// made.
void useCheckedMemory();

}  // namespace wholehand::bullet

namespace wholehand {

namespace bullet {
struct BulletEngine;
}

using BulletSettings = bullet::SolverSettings;

/// The physics engine Bullet 3.24, double precision, in this process. The hand is an articulated
/// body whose contacts are solved in its reduced velocities; the scene's bodies, and those of a
/// game, are rigid bodies.
class BulletWorld final : public PhysicsWorld, public BodyPool {
 public:
  /// Builds the world, reserves every array and runs warm-up steps, so that no step allocates. @pre
  /// hand outlives this; scene as loaded. Not real-time safe.
  BulletWorld(const HandModel& hand, const SceneModel& scene, const BulletSettings& settings = {});
  ~BulletWorld() override;

  [[nodiscard]] Expected<Done> placeHand(const AxisPosition& q_s) override;
  [[nodiscard]] Fault observe(PhysicsState& state) noexcept override;
  void placeBodies(const BodyPlacements& placements) noexcept override;
  [[nodiscard]] Fault step(const HandDrive& drive, double period_s) noexcept override;
  void contacts(ContactList& contacts) const noexcept override;
  void selfForces(SelfForces& forces) const noexcept override;

  [[nodiscard]] BodyPool* bodyPool() noexcept override { return this; }
  void apply(const Command& command) noexcept override;
  void setGameAlive(bool alive) noexcept override;
  void report(PoolReport& report) noexcept override;

 private:
  std::unique_ptr<bullet::BulletEngine> engine_;
};

}  // namespace wholehand
