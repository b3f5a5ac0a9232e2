#pragma once

#include "loop/core/command.hpp"
#include "loop/core/geometry.hpp"
#include "schema_enums.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

/// Bodies that a game puts into the running world: limits, the commands that carry its orders, the
/// report of the pool of slots (docs/adr/0043-bodies-of-a-game.md), and bodies beyond the slots
/// (docs/adr/0054-reach.md). SI units, world frame.
namespace wholehand {

inline constexpr int kMaxSlots = 64;       ///< largest number of game bodies in the world at once
inline constexpr int kMaxShapeSets = 64;   ///< largest number of shape sets at once
inline constexpr int kMaxSlotPieces = 16;  ///< largest number of convex pieces of a body
inline constexpr int kMaxPieceVertices = 64;  ///< largest number of vertices of a convex mesh

/// State of one slot, as the pool reports it.
struct SlotReport {
  /// Generation of the body in the slot; 0: the slot is empty (parked).
  std::int32_t generation = 0;
  SlotState state = SlotState::kParked;
  BodyOwner owner = BodyOwner::kLoop;
  std::int32_t solid_count = 0;  ///< how often the body became solid since it was spawned
};

/// An order that was refused in this tick.
struct RefusedOrder {
  std::int32_t slot = -1;
  BodyRefusal refusal = BodyRefusal::kNone;
};

/// Report of the pool for one tick. The body of slot s is body first_body + s of the record.
struct PoolReport {
  std::int32_t count = 0;  ///< number of slots; 0: the world has no pool
  std::int32_t first_body = 0;
  std::int32_t refused_count = 0;
  std::int32_t moving = 0;  ///< bodies that are simulated and do not rest
  /// Slot whose body was removed in the last step because it was too fast or left the world; -1:
  /// none.
  std::int32_t quarantined = -1;
  double held_j = 0.0;  ///< kinetic energy of the bodies
  /// Energy put into them since the last report by gravity, the game and its orders.
  double received_j = 0.0;
  std::array<SlotReport, kMaxSlots> slots{};
  std::array<RefusedOrder, kMaxCommands> refused{};
};
static_assert(std::is_trivially_copyable_v<PoolReport>);

/// Pose of a body: position of its centre of mass, and orientation of the frame in which its shapes
/// were given.
struct BodyPose {
  Vec3 position_m;
  QuatXyzw orientation_xyzw;
};

/// Order to put a body into an empty slot.
struct SpawnOrder {
  int slot = 0;
  int generation = 1;  ///< > 0; names this body of the slot in all further orders
  int shape_set = 0;
  BodyOwner owner = BodyOwner::kLoop;
  double mass_kg = 0.1;
  double friction = 0.8;  ///< Coulomb coefficient against the hand
  BodyPose pose;
  Vec3 velocity_m_s;  ///< velocity at the instant when it becomes solid; owner kLoop only
  Vec3 spin_rad_s;    ///< angular velocity then
  /// true: an overlap refuses the order; false: the body then appears as a ghost
  bool refuse_overlap = false;
};

// Make the command of an order. Real-time safe.
[[nodiscard]] Command spawnCommand(const SpawnOrder& spawn) noexcept;
[[nodiscard]] Command removeCommand(int slot, int generation) noexcept;
[[nodiscard]] Command teleportCommand(int slot, int generation, const BodyPose& pose) noexcept;
[[nodiscard]] Command setOwnerCommand(int slot, int generation, BodyOwner owner) noexcept;
[[nodiscard]] Command bodyTargetCommand(int slot, int generation, const BodyPose& pose) noexcept;

/// The spawn order that a command carries.
[[nodiscard]] SpawnOrder spawnOrderOf(const Command& command) noexcept;
/// The pose that a teleport or target command carries.
[[nodiscard]] BodyPose poseOf(const Command& command) noexcept;

// Limits of orders; a scene file cannot change them.

/// Largest distance from the origin; a body beyond it has left the world.
inline constexpr double kFarthest_m = 5.0;
inline constexpr double kMostNormFault = 1e-3;  ///< largest deviation of a quaternion's norm from 1
inline constexpr double kMostSpawnSpeed_m_s = 2.0;     ///< largest initial speed of a spawned body
inline constexpr double kMostSpawnSpin_rad_s = 250.0;  ///< largest initial spin of a spawned body
inline constexpr double kMostBodyFriction = 2.0;       ///< largest Coulomb coefficient of a body

/// True for a finite pose inside the world whose quaternion is a rotation. Real-time safe.
[[nodiscard]] inline bool isBodyPose(const BodyPose& pose) noexcept {
  return pose.position_m.eigen().norm() <= kFarthest_m &&
         std::abs(pose.orientation_xyzw.eigen().norm() - 1.0) <= kMostNormFault;
}

[[nodiscard]] inline bool isBodyOwner(BodyOwner owner) noexcept {
  return owner == BodyOwner::kLoop || owner == BodyOwner::kGame || owner == BodyOwner::kFixed;
}

// Registered bodies: a game may have more bodies than the loop has slots.

inline constexpr int kMostRegistered = 1000;  ///< largest number of registered bodies at once
/// Range of the numbers that an order to a registered body carries in place of a slot.
inline constexpr int kFirstNumber = 1000, kLastNumber = 32767;
[[nodiscard]] constexpr bool isRegistered(int slot) noexcept {
  return slot >= kFirstNumber && slot <= kLastNumber;
}

}  // namespace wholehand
