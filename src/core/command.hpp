#pragma once

#include "core/axis_array.hpp"

#include <cstdint>
#include <type_traits>

namespace wholehand {

enum class CommandType : std::int32_t {
  kNone,
  kParameter,  ///< index: into the live parameters; value: where its ramp goes
  kAction,     ///< index: an ExerciseAction
  kOwner,      ///< value: 1 while whoever shows the exercise is alive, 0 when it went silent
  kAim,        ///< aim: where the person at the screen wants the hand to be
  kSteer       ///< index: a Steering
};

enum class ExerciseAction : std::int32_t {
  kNext,
  kRestart,
  kPause,
  kResume,
  kBeginAt  ///< value: where in its level the exercise goes on after a rest; no client sends it
};

/// Who says where the virtual patient wants to be.
enum class Steering : std::int32_t { kVirtualPatient, kPerson };

/// What other threads ask of the loop: drained by the session before a tick, at most kMaxCommands a
/// tick, and kept in its record, so that a replay asks the same.
struct Command {
  CommandType type = CommandType::kNone;
  std::int32_t index = 0;
  double value = 0.0;
  AxisPosition aim;
};

/// The most commands that one tick takes.
inline constexpr int kMaxCommands = 8;

static_assert(std::is_trivially_copyable_v<Command>);

}  // namespace wholehand
