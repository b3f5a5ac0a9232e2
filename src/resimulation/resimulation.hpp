#pragma once

#include "resimulation/tick_comparison.hpp"
#include "telemetry/black_box_reader.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <string>

namespace wholehand {

/// What a re-simulation came to.
struct Resimulation {
  std::uint64_t ticks = 0;           ///< run again
  std::uint64_t compared = 0;        ///< of these, with what was recorded
  TickDifference difference;         ///< the first one; its field is empty where all is identical
  std::uint64_t different_tick = 0;  ///< where it is
};

/// Runs the recorded inputs (positions, skipped periods, device faults, stop requests, commands)
/// through a renderer built from the files that the recording carries, and compares. Refused where
/// ticks are missing in it.
[[nodiscard]] Expected<Resimulation> resimulate(RecordingReader& recording,
                                                const std::string& path);

/// The same from the arming on with the inputs of a black box; compared are the ticks it holds
/// whole. Refused where it does not hold all inputs.
[[nodiscard]] Expected<Resimulation> resimulate(BlackBoxReader& box, const std::string& path);

}  // namespace wholehand
