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
  kHolderAlive,  ///< value: 1 while the client that holds the controls is alive, 0 when it is
                 ///< silent
  kAim,    ///< aim: target pose of the person at the screen; index: the Help that the page gives
  kSteer,  ///< index: a Steering
  // Orders of a game to its bodies; loop/core/body_order.hpp writes and reads them.
  kShapeSet,       ///< index: shape set; value: pieces
  kShapePiece,     ///< index: shape set; value: piece
  kShapeVertices,  ///< index: shape set; value: piece
  kSpawn,          ///< index: slot; value: generation; the commands below use the same fields
  kRemove,
  kTeleport,
  kSetOwner,
  kBodyTarget
};

/// True for the orders of a game to its bodies, which use Command::numbers.
[[nodiscard]] constexpr bool isBodyOrder(CommandType type) noexcept {
  return type >= CommandType::kShapeSet && type <= CommandType::kBodyTarget;
}

/// Size of Command::numbers.
inline constexpr int kOrderNumbers = 18;

/// An action that only the program itself sends, never a client. Command::value is the place in the
/// level from which the exercise resumes.
inline constexpr Act kBeginAt{kActs};

/// Answer in an exercise that compares, as Command::value of Act::kNext.
enum class Choice : std::int32_t { kNone, kFirst, kSecond };
inline constexpr int kChoices = 3;
/// @return choice, plus kChoices when a therapist answered for the person
[[nodiscard]] constexpr double choiceValue(Choice choice, bool by_therapist) noexcept {
  return static_cast<double>(choice) + (by_therapist ? kChoices : 0);
}

/// A request from another thread to the loop. The session takes at most kMaxCommands before a tick
/// and stores them in the tick's record, so that a re-simulation repeats them.
struct Command {
  CommandType type = CommandType::kNone;
  std::int32_t index = 0;
  double value = 0.0;
  AxisPosition aim;
  std::array<double, kOrderNumbers> numbers{};  ///< data of a body order; 0 in other commands
};

/// Largest number of commands taken by one tick.
inline constexpr int kMaxCommands = 8;

static_assert(std::is_trivially_copyable_v<Command>);

}  // namespace wholehand
