#pragma once

#include "assembly/rig.hpp"
#include "telemetry/recording.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// The first field in which two ticks differ, "" where none does. Compared bit by bit: all that is
/// a function of the recorded inputs. Times on the clock are not.
[[nodiscard]] std::string firstDifference(const TickRecord& recorded, const TickRecord& again);

/// What a re-simulation came to.
struct Resimulation {
  std::uint64_t ticks = 0;
  std::uint64_t different_tick = 0;  ///< valid when `field` is not empty
  std::string field;                 ///< the first field that differs; empty: identical
  std::string recorded, again;       ///< its values
};

/// The models of the files that a recording carries; `recording` is its path, for messages.
[[nodiscard]] Expected<Models> recordedModels(const RecordingMeta& meta,
                                              const std::string& recording);

/// Runs the recorded inputs (positions, skipped periods, device faults, stop requests) through a
/// renderer built from the files that the recording carries, and compares.
[[nodiscard]] Expected<Resimulation> resimulate(RecordingReader& recording,
                                                const std::string& path);

}  // namespace wholehand
