#pragma once

#include "resimulation/tick_comparison.hpp"
#include "telemetry/black_box_reader.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <string>

namespace wholehand {

/// Result of a re-simulation.
struct Resimulation {
  std::uint64_t ticks = 0;           ///< ticks run again
  std::uint64_t compared = 0;        ///< of these, compared with the recording
  TickDifference difference;         ///< first difference; its field is empty when all ticks are
                                     ///< identical
  std::uint64_t different_tick = 0;  ///< tick of that difference
};

/// Runs the recorded inputs (positions, skipped periods, device faults, stop requests, commands)
/// through a renderer built from the recording's own files, and compares the results. Refused when
/// ticks are missing.
[[nodiscard]] Expected<Resimulation> resimulate(RecordingReader& recording,
                                                const std::string& path);

/// As above, from arming on, with the inputs of a black box; compares the ticks that it holds
/// completely. Refused when inputs are missing.
[[nodiscard]] Expected<Resimulation> resimulate(BlackBoxReader& box, const std::string& path);

}  // namespace wholehand
