#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/tick_record.hpp"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace wholehand {

/// Time in which the person was active, in periods.
struct ActivePeriods {
  std::uint64_t active = 0;  ///< by the person's own aim or effort, with some help or without
  std::uint64_t helped = 0;  ///< part of `active` with some help
  std::uint64_t led = 0;     ///< with full help: the page moved the hand; no part of `active`
};

/// Counts from the ticks of one session for how long the person was active. This is the only place
/// that says what active means.
///
/// A tick is active if the person moves the hand (TickRecord::moved_by), the exercise is not
/// paused, the client that holds the controls is present, and within the last 2 s the person's own
/// aim moved the hand. A hand moves when an axis is 1 mm or 1 degree away from where it was when it
/// last moved. For a simulated hand this is the intention, after the first aim; for a person in a
/// device it is the device's position, and a grip of at least 1 N counts like a movement. A tick
/// with full help is led instead: the aim is the page's. A pause, an absence and a change between
/// own and led begin anew: what moved before does not count afterwards.
class ActiveTime {
 public:
  /// @param axis_units "m" or "rad" of each axis @param value_names of the exercise's values
  ActiveTime(const std::vector<std::string>& axis_units,
             const std::vector<std::string>& value_names);

  /// Adds the next tick. Does not allocate.
  void add(const TickRecord& record) noexcept;
  [[nodiscard]] const ActivePeriods& periods() const noexcept { return periods_; }
  /// True when the exercise is paused in this tick, or the client that holds the controls is
  /// absent.
  [[nodiscard]] bool interrupted(const TickRecord& record) const noexcept;

 private:
  enum class Kind : std::uint8_t { kNone, kOwn, kLed };
  [[nodiscard]] Kind kindOf(const TickRecord& record) const noexcept;
  [[nodiscard]] bool moves(const TickRecord& record) noexcept;
  [[nodiscard]] bool leaves(const AxisPosition& at) noexcept;

  AxisPosition least_move_;  ///< [m or rad]
  int paused_value_ = -1, grip_value_ = -1;
  Kind kind_ = Kind::kNone;
  bool aimed_ = false;  ///< an aim was given since this kind began
  AxisPosition last_;   ///< where the hand was when it last moved; no axes: not seen yet
  double moved_s_ = -std::numeric_limits<double>::infinity();
  ActivePeriods periods_;
};

/// Exercise value that holds the grip force [N], and the one that is 1 during a pause.
inline constexpr const char* kGripForceValue = "squeeze_n";
inline constexpr const char* kPausedValue = "paused";
/// Smallest grip force of a grip; a smaller one counts as a touch only.
inline constexpr double kLeastGrip_n = 1.0;

}  // namespace wholehand
