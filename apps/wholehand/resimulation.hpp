#pragma once

#include "telemetry/recording.hpp"
#include "tick_comparison.hpp"

#include <cstdint>
#include <string>

namespace wholehand {

/// What a re-simulation came to.
struct Resimulation {
  std::uint64_t ticks = 0;           ///< run again
  TickDifference difference;         ///< the first one; its field is empty where all is identical
  std::uint64_t different_tick = 0;  ///< where it is
};

/// Runs the recorded inputs (positions, skipped periods, device faults, stop requests) through a
/// renderer built from the files that the recording carries, and compares.
[[nodiscard]] Expected<Resimulation> resimulate(RecordingReader& recording,
                                                const std::string& path);

}  // namespace wholehand
