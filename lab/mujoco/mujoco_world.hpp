#pragma once

#include "lab/mujoco/solver_settings.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/physics_world.hpp"

#include <memory>

namespace wholehand {

namespace mujoco {
class MujocoEngine;
}

using MujocoSettings = mujoco::SolverSettings;

/// World with the physics engine MuJoCo. The hand is an articulated body whose constraints are
/// projected onto its synergy; the scene's bodies are free or placed. ADR 39 explains the settings.
class MujocoWorld final : public PhysicsWorld {
 public:
  /// Compiles the model and allocates all memory, so that no step allocates. An error names the
  /// part that MuJoCo does not accept. @pre hand outlives the world. Not real-time safe.
  [[nodiscard]] static Expected<std::unique_ptr<PhysicsWorld>> build(
      const HandModel& hand, const SceneModel& scene, const MujocoSettings& settings = {});
  ~MujocoWorld() override;

  [[nodiscard]] Expected<Done> placeHand(const AxisPosition& q_s) override;
  [[nodiscard]] Fault observe(PhysicsState& state) noexcept override;
  void placeBodies(const BodyPlacements& placements) noexcept override;
  [[nodiscard]] Fault step(const HandDrive& drive, double period_s) noexcept override;
  void contacts(ContactList& contacts) const noexcept override;
  void selfForces(SelfForces& forces) const noexcept override;

  /// For measurements of the cost of a setting.
  [[nodiscard]] mujoco::MujocoEngine& engine() noexcept { return *engine_; }

 private:
  explicit MujocoWorld(const HandModel& hand, std::unique_ptr<mujoco::MujocoEngine> engine);

  const HandModel* hand_;
  Synergy synergy_;
  std::unique_ptr<mujoco::MujocoEngine> engine_;
};

}  // namespace wholehand
