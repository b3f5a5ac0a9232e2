#pragma once

#include "resimulation/tick_comparison.hpp"
#include "telemetry/black_box_reader.hpp"
#include "telemetry/input_journal.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// Result of a re-simulation.
struct Resimulation {
  std::uint64_t ticks = 0;     ///< ticks run again
  std::uint64_t compared = 0;  ///< of these, compared with the recording
  /// First tick of which a bit differs: its digest does, or a number of a black box.
  std::optional<std::uint64_t> different_tick;
  /// First tick, this one or a later one, in which recorded numbers differ, and which do. A digest
  /// shows what single precision hides.
  std::uint64_t visible_tick = 0;
  std::vector<TickDifference> visible;

  [[nodiscard]] bool same() const noexcept { return !different_tick && visible.empty(); }
};

/// Runs the recorded inputs (positions, skipped periods, device faults, stop requests, commands)
/// through a renderer built from the recording's own files, and compares the results. Refused when
/// ticks are missing.
[[nodiscard]] Expected<Resimulation> resimulate(RecordingReader& recording,
                                                const std::string& path);

/// As above, from arming on, with the inputs of a black box; compares the ticks that it holds
/// completely. Refused when inputs are missing.
[[nodiscard]] Expected<Resimulation> resimulate(BlackBoxReader& box, const std::string& path);

/// Runs the inputs of a journal again and records every tick, as the recording would have been but
/// for clock times and the numbers of the virtual patient.
/// @return ticks that were recorded
[[nodiscard]] Expected<std::uint64_t> recordAgain(InputJournalReader& journal,
                                                  const std::string& path, RecordingWriter& writer);

}  // namespace wholehand
