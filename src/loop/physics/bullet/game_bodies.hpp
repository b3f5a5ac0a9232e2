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
/// nothing: a ghost has a pose and colliders, but no solver rows. When an order takes a body away
/// while the hand presses it, the force on the hand fades first. Real-time safe except for
/// construction.
class GameBodies final : public BodyPool {
 public:
  /// @pre all outlive this; the last scene.game.slots bodies are empty slots
  GameBodies(const SceneModel& scene, std::vector<BulletBody>& bodies, RestingBodies& resting,
             ColliderPairs& pairs, ReducedContactSolver& solver, btCollisionDispatcher& dispatcher);

  void apply(const Command& command) noexcept override;
  void setGameAlive(bool alive) noexcept override { alive_ = alive; }
  void report(PoolReport& report) noexcept override;

  /// Makes ghosts that overlap nothing solid. Call after the pairs of a step are found and before
  /// the step is solved.
  WHOLEHAND_RT void settle(double step_s) noexcept;
  /// Pulls driven bodies to their targets and moves driven ghosts. Call before a step is solved;
  /// gravity is applied afterwards.
  WHOLEHAND_RT void drive(double step_s) noexcept;
  /// Continues releases, parks bodies that left the world, and counts the time of silence. Call
  /// after a step.
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
  /// Time after an overlap in which the bound of the contact force grows to its full value [s].
  static constexpr double kFull_s = 0.3;

  /// What happens to a body when the force of the hand on it has faded.
  enum class Then { kPark, kTeleport, kSetOwner };
  struct Slot {
    int generation = 0;
    SlotState state = SlotState::kParked;
    BodyOwner owner = BodyOwner::kLoop;
    int shape_set = -1;
    double mass_kg = 0.0, friction = 0.0, radius_m = 0.0;
    Vec3 velocity_m_s;  ///< velocity that a ghost of owner kLoop gets when it becomes solid
    Vec3 spin_rad_s;    ///< angular velocity that it then gets
    bool refuse_overlap = false;  ///< an overlap in the first step refuses the spawn
    BodyPose target;              ///< target of a driven body
    double target_age_s = 0.0;
    int solid_count = 0;
    // While the force of the hand on the body fades.
    Then then = Then::kPark;
    bool by_target = false;  ///< the teleport comes from a target that was too far for one frame
    BodyPose there;
    BodyOwner next_owner = BodyOwner::kLoop;
    double left_s = 0.0, lasts_s = 0.0, impulse_ns = 0.0;
    // For a ghost and for the solid body that it becomes.
    bool overlapped = false;  ///< the ghost overlapped something
    double solid_s = 0.0;     ///< time since it became solid, while the bound grows
  };

  struct Pull {
    btVector3 force_n{0.0, 0.0, 0.0}, torque_nm{0.0, 0.0, 0.0};
    /// Size of the force plus that of the torque at the body's outermost point.
    double size_n = 0.0;
    double share = 0.0;  ///< share of the pull that acts
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
  /// Pull on a driven body, before it is shared with other bodies; moves a ghost.
  [[nodiscard]] Pull pullOf(int index, double step_s) noexcept;
  /// Power of gravity and pull [W], and the kinetic energy of the solid bodies [J].
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
  std::array<Pull, kMaxSlots> pulls_{};  ///< pulls on driven bodies, valid until the step ends
  int ghosts_ = 0, used_ = 0;
  bool alive_ = true;
  bool hand_touches_ = false;  ///< the hand touched something in the last step
  double step_s_ = 1e-3;       ///< duration of the last step
  double silent_s_ = 0.0;
  double force_share_ = 1.0;  ///< share of the driven bodies' force; falls while the game is silent
  unsigned version_ = 0;
  std::array<RefusedOrder, kMaxCommands> refused_{};
  int refused_count_ = 0;
  int quarantined_ = -1;
  double held_j_ = 0.0, received_j_ = 0.0;  ///< as in PoolReport
  double power_w_ = 0.0;                    ///< power of gravity and pull before the step is solved
};

}  // namespace wholehand::bullet
