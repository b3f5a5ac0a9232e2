#pragma once

#include "loop/core/body_order.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/bullet/bullet_bodies.hpp"
#include "loop/physics/bullet/collider_pairs.hpp"
#include "loop/physics/bullet/reduced_contact_solver.hpp"
#include "loop/physics/bullet/resting_bodies.hpp"
#include "loop/physics/bullet/shape_sets.hpp"
#include "loop/physics/physics_world.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

#include <array>
#include <utility>
#include <vector>

namespace wholehand::bullet {

/// The bodies of a game: slots after the scene's bodies. A slot's body is a ghost until it overlaps
/// nothing: it has a pose and colliders, but no solver rows. An order that takes a body away from
/// the hand that presses it lets the force on the hand fade first. Real-time safe except for
/// construction.
class GameBodies final : public BodyPool {
 public:
  /// @pre all outlive this; the last scene.game.slots bodies are empty slots
  GameBodies(const SceneModel& scene, std::vector<BulletBody>& bodies, RestingBodies& resting,
             ColliderPairs& pairs, ReducedContactSolver& solver, btCollisionDispatcher& dispatcher);

  void obey(const Command& command) noexcept override;
  void setGameAlive(bool alive) noexcept override { alive_ = alive; }
  void report(PoolReport& report) noexcept override;

  /// Call after the pairs of a step are found, before it is solved: ghosts that overlap nothing
  /// become solid.
  WHOLEHAND_RT void settle(double step_s) noexcept;
  /// Call before a step is solved: pulls driven bodies to their targets, and moves driven ghosts.
  /// Then gravity is applied.
  WHOLEHAND_RT void drive(double step_s) noexcept;
  /// Call after a step: lets go, parks what left the world, and counts the time of silence.
  WHOLEHAND_RT void finish(double step_s) noexcept;

  /// True for a body without solver rows.
  [[nodiscard]] bool isGhost(int body) const noexcept {
    return body >= first_ && slots_[body - first_].state == SlotState::kGhost;
  }
  /// Changes whenever a ghost appears or becomes solid, or a body is parked.
  [[nodiscard]] unsigned version() const noexcept { return version_; }
  [[nodiscard]] int firstBody() const noexcept { return first_; }
  [[nodiscard]] int count() const noexcept { return static_cast<int>(slots_.size()); }

 private:
  /// Time after an overlap in which the bound of the contact force grows to its full value.
  static constexpr double kFull_s = 0.3;

  /// What happens to a body when the hand has let go of it.
  enum class Then { kPark, kTeleport, kSetOwner };
  struct Slot {
    int generation = 0;
    SlotState state = SlotState::kParked;
    BodyOwner owner = BodyOwner::kLoop;
    int shape_set = -1;
    double mass_kg = 0.0, friction = 0.0, radius_m = 0.0;
    Vec3 velocity_m_s;            ///< when a ghost of the loop becomes solid
    Vec3 spin_rad_s;              ///< likewise
    bool refuse_overlap = false;  ///< until the first step
    BodyPose target;              ///< of a driven body
    double target_age_s = 0.0;
    int solid_count = 0;
    // While it lets go.
    Then then = Then::kPark;
    bool by_target = false;  ///< a target too far for a frame asked for the teleport
    BodyPose there;
    BodyOwner next_owner = BodyOwner::kLoop;
    double left_s = 0.0, lasts_s = 0.0, impulse_ns = 0.0;
    // Of a ghost, and of what it becomes.
    bool overlapped = false;  ///< something was where it is
    double solid_s = 0.0;     ///< time since then, up to the end of the bound
  };

  struct Pull {
    btVector3 force_n{0.0, 0.0, 0.0}, torque_nm{0.0, 0.0, 0.0};
    double size_n = 0.0;  ///< of the force, with the turn at the body's outermost point
    double share = 0.0;   ///< of it that acts
  };

  void spawn(const SpawnOrder& order) noexcept;
  void orderBody(const Command& command) noexcept;
  void letGo(int index, Then then) noexcept;
  void carryOut(int index) noexcept;
  void becomeGhost(int index) noexcept;
  void becomeSolid(int index) noexcept;
  void park(int index) noexcept;
  void refuse(int slot, BodyRefusal refusal) noexcept;
  [[nodiscard]] int movingCount() const noexcept;
  [[nodiscard]] BodyPose poseNow(int slot) const noexcept;
  void findOverlaps() noexcept;
  void noteOverlap(const ColliderTag& of, const ColliderTag& with) noexcept;
  [[nodiscard]] bool isDriven(int slot) const noexcept;
  /// The force on a driven body by itself; moves a ghost.
  [[nodiscard]] Pull pullOf(int index, double step_s) noexcept;
  /// Power of gravity and pull, and the kinetic energy of the solid bodies.
  [[nodiscard]] std::pair<double, double> powerAndEnergy() noexcept;
  void holdWithin(int index) noexcept;
  void fade(int index, double step_s) noexcept;
  void firm(int index, double step_s) noexcept;
  void watchSilence(double step_s) noexcept;
  BulletBody& bodyOf(int slot) noexcept { return bodies_[first_ + slot]; }

  const GameBudget budget_;
  const btVector3 gravity_;
  std::vector<BulletBody>& bodies_;
  RestingBodies& resting_;
  ColliderPairs& pairs_;
  ReducedContactSolver& solver_;
  btCollisionDispatcher& dispatcher_;
  const int first_;
  ShapeSets sets_;
  std::vector<Slot> slots_;
  std::array<bool, kMaxSlots> overlaps_{};
  std::array<Pull, kMaxSlots> pulls_{};  ///< of driven bodies, until the step ends
  int ghosts_ = 0, used_ = 0;
  bool alive_ = true;
  bool hand_touches_ = false;  ///< anything, in the last step
  double step_s_ = 1e-3;       ///< of the last step
  double silent_s_ = 0.0;
  double force_share_ = 1.0;  ///< of the driven bodies' force: falls while the game is silent
  unsigned version_ = 0;
  std::array<RefusedOrder, kMaxCommands> refused_{};
  int refused_count_ = 0;
  int quarantined_ = -1;
  double held_j_ = 0.0, received_j_ = 0.0;  ///< as PoolReport says
  double power_w_ = 0.0;                    ///< of gravity and pull, before the step is solved
};

}  // namespace wholehand::bullet
