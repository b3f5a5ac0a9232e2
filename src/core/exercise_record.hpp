#pragma once

#include "core/axis_array.hpp"

#include <array>
#include <cstdint>
#include <type_traits>

namespace wholehand {

/// The most numbers an exercise shows of itself in a tick.
inline constexpr int kMaxExerciseValues = 48;
/// The most events of one tick; further ones are dropped.
inline constexpr int kMaxExerciseEvents = 8;

/// Something that happened in the exercise.
struct ExerciseEvent {
  std::int32_t type = 0;    ///< index into ExerciseDescription::event_names
  std::int32_t index = -1;  ///< which dispenser, liquid ...; -1 where it has none
  double value = 0.0;       ///< in the event's own unit
};

/// What the exercise did in a tick: its effort and its figures, named by its description.
struct ExerciseRecord {
  AxisEffort effort;      ///< f_e [N or N·m]; 0 on every axis without an exercise
  double alpha = 0.0;     ///< of the transition, Eq. (16), 0 .. 1
  AxisRatio wall_active;  ///< 1 on axes with a wall
  AxisPosition wall;      ///< θ_wall per axis; meaningful where wall_active is 1
  std::int32_t value_count = 0;
  std::int32_t event_count = 0;
  std::array<double, kMaxExerciseValues> values{};
  std::array<ExerciseEvent, kMaxExerciseEvents> events{};
};

static_assert(std::is_trivially_copyable_v<ExerciseRecord>);

}  // namespace wholehand
