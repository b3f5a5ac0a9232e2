#pragma once

#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/physics_world.hpp"

#include <memory>

namespace wholehand {

namespace bullet_paper {
struct PaperEngine;
enum class PaperCoupling;
}  // namespace bullet_paper

/// The paper's method as a baseline. A stock btMultiBody is driven by joint torques, with Bullet's
/// own collision detection and solver. Coupled joints are reset to the synergy after each step, or
/// geared to the joint that leads their axis. Contacts do not do the virtual work of f_s, so this
/// world must not be used with a person (docs/engines.md).
class BulletPaperWorld final : public PhysicsWorld {
 public:
  /// Builds the world. An error names the feature that stock Bullet does not support. @pre hand
  /// outlives the world. Not real-time safe.
  [[nodiscard]] static Expected<std::unique_ptr<PhysicsWorld>> build(const HandModel& hand,
                                                                     const SceneModel& scene);
  /// Builds the world with gear constraints instead of the resets.
  [[nodiscard]] static Expected<std::unique_ptr<PhysicsWorld>> buildGeared(const HandModel& hand,
                                                                           const SceneModel& scene);
  ~BulletPaperWorld() override;

  [[nodiscard]] Expected<Done> placeHand(const AxisPosition& q_s) override;
  [[nodiscard]] Fault observe(PhysicsState& state) noexcept override;
  void placeBodies(const BodyPlacements& placements) noexcept override;
  [[nodiscard]] Fault step(const HandDrive& drive, double period_s) noexcept override;
  void contacts(ContactList& contacts) const noexcept override;
  void selfForces(SelfForces& forces) const noexcept override;

 private:
  explicit BulletPaperWorld(std::unique_ptr<bullet_paper::PaperEngine> engine);
  [[nodiscard]] static Expected<std::unique_ptr<PhysicsWorld>> buildWith(
      const HandModel& hand, const SceneModel& scene, bullet_paper::PaperCoupling coupling);

  std::unique_ptr<bullet_paper::PaperEngine> engine_;
};

}  // namespace wholehand
