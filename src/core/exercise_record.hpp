#pragma once

#include "core/axis_array.hpp"

#include <array>
#include <cstdint>
#include <type_traits>

namespace wholehand {

/// Most values that an exercise reports per tick.
inline constexpr int kMaxExerciseValues = 48;
/// Most events of one tick; further ones are dropped.
inline constexpr int kMaxExerciseEvents = 8;

/// Something that happened in the exercise.
struct ExerciseEvent {
  std::int32_t type = 0;    ///< index into ExerciseDescription::event_names
  std::int32_t index = -1;  ///< dispenser, liquid ...; -1: not applicable
  double value = 0.0;       ///< in the event's own unit
};

/// Effort, values and events of the exercise in one tick. Its ExerciseDescription names them.
struct ExerciseRecord {
  AxisEffort effort;     ///< f_e [N or N·m]; 0 without an exercise
  double alpha = 0.0;    ///< α of the transition, Eq. (16), 0 .. 1
  AxisFlag wall_active;  ///< the axis has a wall
  AxisPosition wall;     ///< θ_wall [m or rad]; valid where wall_active is set
  std::int32_t value_count = 0;
  std::int32_t event_count = 0;
  std::array<double, kMaxExerciseValues> values{};
  std::array<ExerciseEvent, kMaxExerciseEvents> events{};
};

static_assert(std::is_trivially_copyable_v<ExerciseRecord>);

}  // namespace wholehand
