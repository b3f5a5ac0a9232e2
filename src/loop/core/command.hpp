#pragma once

#include "loop/core/axis_array.hpp"
#include "schema_enums.hpp"

#include <array>
#include <cstdint>
#include <type_traits>

namespace wholehand {

enum class CommandType : std::int32_t {
  kNone,
  kParameter,    ///< index: live parameter; value: target of its ramp
  kAction,       ///< index: an Act
  kHolderAlive,  ///< value: 1 while the controls' holder is alive, 0 when it is silent
  kAim,          ///< aim: target pose of the person at the screen; index: a Help, of its page
  kSteer,        ///< index: a Steering
  // Orders of a game to its bodies; loop/core/body_order.hpp makes and reads them.
  kShapeSet,       ///< index: shape set; value: pieces
  kShapePiece,     ///< index: shape set; value: piece
  kShapeVertices,  ///< index: shape set; value: piece
  kSpawn,          ///< index: slot; value: generation; so do the rest
  kRemove,
  kTeleport,
  kSetOwner,
  kBodyTarget
};

/// True for the orders of a game to its bodies, which use Command::numbers.
[[nodiscard]] constexpr bool isBodyOrder(CommandType type) noexcept {
  return type >= CommandType::kShapeSet && type <= CommandType::kBodyTarget;
}

/// Numbers of a body order.
inline constexpr int kOrderNumbers = 16;

/// What no client sends, beside Act. Command::value: place in the level to resume from.
inline constexpr Act kBeginAt{kActs};

/// A request of another thread to the loop. The session takes at most kMaxCommands before a tick
/// and stores them in its record, so that a re-simulation repeats them.
struct Command {
  CommandType type = CommandType::kNone;
  std::int32_t index = 0;
  double value = 0.0;
  AxisPosition aim;
  std::array<double, kOrderNumbers> numbers{};  ///< of a body order; 0 in all others
};

/// Most commands taken by one tick.
inline constexpr int kMaxCommands = 8;

static_assert(std::is_trivially_copyable_v<Command>);

}  // namespace wholehand
