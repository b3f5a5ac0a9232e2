#pragma once

#include "loop/core/command.hpp"
#include "loop/core/geometry.hpp"
#include "schema_enums.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

/// Bodies that a game puts into the running world: limits, the commands that carry its orders, what
/// the pool of slots reports (docs/adr/0043-bodies-of-a-game.md), and bodies beyond the slots
/// (docs/adr/0054-reach.md). SI units, world frame.
namespace wholehand {

inline constexpr int kMaxSlots = 64;          ///< bodies of a game at once
inline constexpr int kMaxShapeSets = 64;      ///< shape sets of a game at once
inline constexpr int kMaxSlotPieces = 16;     ///< convex pieces of a body
inline constexpr int kMaxPieceVertices = 64;  ///< vertices of a convex mesh

/// What the pool says of a slot.
struct SlotReport {
  std::int32_t generation = 0;  ///< of the body; 0: parked
  SlotState state = SlotState::kParked;
  BodyOwner owner = BodyOwner::kLoop;
  std::int32_t solid_count = 0;  ///< how often the body became solid, since it was spawned
};

/// An order that was refused in this tick.
struct RefusedOrder {
  std::int32_t slot = -1;
  BodyRefusal refusal = BodyRefusal::kNone;
};

/// What the pool says in a tick. A slot's body is body first_body + slot of the record.
struct PoolReport {
  std::int32_t count = 0;  ///< slots; 0: the world has no pool
  std::int32_t first_body = 0;
  std::int32_t refused_count = 0;
  std::int32_t moving = 0;        ///< bodies that are simulated and do not rest
  std::int32_t quarantined = -1;  ///< slot whose body was taken out in the last step; -1: none
  double held_j = 0.0;            ///< kinetic energy of the bodies
  double received_j =
      0.0;  ///< put into them since the last report by gravity, the game, its orders
  std::array<SlotReport, kMaxSlots> slots{};
  std::array<RefusedOrder, kMaxCommands> refused{};
};
static_assert(std::is_trivially_copyable_v<PoolReport>);

/// Pose of a body: its centre of mass, and the orientation of the frame its shapes were given in.
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
  Vec3 velocity_m_s;            ///< when it becomes solid; owner kLoop only
  Vec3 spin_rad_s;              ///< the same; to 1/256 rad/s, below 256 rad/s about each axis
  bool refuse_overlap = false;  ///< refused instead of a ghost where it overlaps something
};

// The commands of the orders. Real-time safe.
[[nodiscard]] Command spawnCommand(const SpawnOrder& spawn) noexcept;
[[nodiscard]] Command removeCommand(int slot, int generation) noexcept;
[[nodiscard]] Command teleportCommand(int slot, int generation, const BodyPose& pose) noexcept;
[[nodiscard]] Command setOwnerCommand(int slot, int generation, BodyOwner owner) noexcept;
[[nodiscard]] Command bodyTargetCommand(int slot, int generation, const BodyPose& pose) noexcept;

/// Numbers of a spawn, as they stand in Command::numbers.
[[nodiscard]] SpawnOrder spawnOrderOf(const Command& command) noexcept;
/// Pose of a teleport or a target.
[[nodiscard]] BodyPose poseOf(const Command& command) noexcept;

// Limits of orders that no scene file changes.

inline constexpr double kFarthest_m = 5.0;  ///< from the origin; farther, a body has left the world
inline constexpr double kMostNormFault = 1e-3;  ///< of a quaternion's norm, from 1
inline constexpr double kMostSpawnSpeed_m_s = 2.0;
inline constexpr double kMostBodyFriction = 2.0;

/// True for a finite pose inside the world whose quaternion is a rotation. Real-time safe.
[[nodiscard]] inline bool isBodyPose(const BodyPose& pose) noexcept {
  return pose.position_m.eigen().norm() <= kFarthest_m &&
         std::abs(pose.orientation_xyzw.eigen().norm() - 1.0) <= kMostNormFault;
}

[[nodiscard]] inline bool isBodyOwner(BodyOwner owner) noexcept {
  return owner == BodyOwner::kLoop || owner == BodyOwner::kGame || owner == BodyOwner::kFixed;
}

// Bodies beyond the slots.

inline constexpr int kMostRegistered = 1000;  ///< bodies at once
/// What stands in place of a slot in an order to a registered body.
inline constexpr int kFirstNumber = 1000, kLastNumber = 32767;
[[nodiscard]] constexpr bool isRegistered(int slot) noexcept {
  return slot >= kFirstNumber && slot <= kLastNumber;
}

/// A registered body, as others see it.
struct RegisteredBody {
  int number = 0;
  int generation = 0;
  int shape_set = 0;
  int slot = -1;  ///< of kInSlot
  Whereabouts whereabouts = Whereabouts::kOutOfReach;
  BodyPose pose;  ///< newest that is known
};

}  // namespace wholehand
