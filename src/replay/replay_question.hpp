#pragma once

#include "loop/core/expected.hpp"

#include <cstdint>
#include <string>
#include <string_view>

namespace wholehand {

inline constexpr std::uint64_t kMostStates = 256;
inline constexpr double kLongestSeries_s = 60.0;
inline constexpr int kMostColumns = 2000;

/// Asks for the states at the rows first, first + step, ... of a recording.
struct StatesQuestion {
  std::uint64_t first = 0, count = 0, step = 1;
};

/// Asks for the extremes of every channel in each of `columns` equal parts of a time interval.
struct SeriesQuestion {
  double from_s = 0.0, to_s = 0.0;
  int columns = 0;
};

/// A page's question about a recording (docs/protocol.md, "Looking at a recording again"). Numbers
/// of the answers are little-endian.
///
/// about: JSON with name, title, profile, created_utc, program_version, period_s, ticks (readable),
/// ticks_missing (between them), from_s, to_s (last tick's time and a period), simulated_device,
/// patient, device, hand, exercise, level, still_written, whole (false: unreadable from
/// unreadable_from_s on), run_again (--resimulate is possible), picture (false: no scene, because
/// of no_picture_because), axes (name, unit, effort_limit, lever_arm_m), value_names, event_names,
/// result (name of value_names, label, value, unit, decimals).
///
/// states: of rows first, first + step, ..., each as its length (uint32) and a message with a
/// WorldState; fewer where the recording ends or is unreadable. run_state is Rendering, session 1,
/// latched_faults the tick's stopping faults; statistics, device, fault_ticks, and without a
/// picture the links, are absent.
///
/// bodies: for every change of a game's bodies the row (uint32), the length (uint32) and a message
/// with GameBodies; may be empty.
///
/// series, over from_s <= t < to_s: the length of its header (uint32), the header as JSON padded
/// with spaces, and for each of its channels as many minima and maxima as columns, float32; NaN
/// where a part has no finite value. Channels have a name and an axis: q_m, q_s, intention, sent,
/// exercise_effort, damping, phi of each axis; alpha, palm_target_distance_m (NaN without a
/// target), contact_force_n (sum of magnitudes), contact_count, duration_s (of the tick; its CPU
/// time on a simulated clock); value of the exercise (axis: index in value_names); units as in
/// docs/recording.md. The header has from_s, to_s, columns, first_tick (first row at or after
/// from_s), events (time_s, type, index, value), gaps (from_s, to_s, number of ticks that ran and
/// are missing), marks (time_s, kind, text, axis where one begins: armed, stop, emergency_stop,
/// fault (stopping ones, named in text), controls_lost, neutral (no effort)), unreadable (stretches
/// of damaged ticks) and truncated (there are such, or over 20,000 events or 5,000 marks or gaps).
struct ReplayQuestion {
  enum class Kind { kAbout, kScene, kStates, kSeries, kBodies };
  Kind what = Kind::kAbout;
  StatesQuestion states;
  SeriesQuestion series;
};

/// Parses "about", "scene", "bodies", "states?tick=..&count=..&step=.." or
/// "series?from_s=..&to_s=..&columns=..". Ignores other keys of the query. An unknown question is
/// refused with key "", a missing or out-of-range number with its key.
[[nodiscard]] Expected<ReplayQuestion> parseReplayQuestion(std::string_view question);

/// The question in the form that parseReplayQuestion() reads, without ignored keys.
[[nodiscard]] std::string textOf(const ReplayQuestion& question);

}  // namespace wholehand
