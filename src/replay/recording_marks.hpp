#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A notable moment of a recording.
struct RecordingMark {
  double time_s = 0.0;
  std::string kind;  ///< stop, emergency_stop, fault, controls_lost, armed, neutral
  std::string text;  ///< names of the faults; empty for other kinds
  std::string axis;  ///< axis whose limit was exceeded; empty: none
};

/// The marks that begin in a tick.
/// @param before the previous tick of the recording; null for the first
[[nodiscard]] std::vector<RecordingMark> marksOf(const TickRecord& record, const TickRecord* before,
                                                 const RecordingMeta& meta);

}  // namespace wholehand
