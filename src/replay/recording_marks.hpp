#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A moment of a recording that a person looks for.
struct RecordingMark {
  double time_s = 0.0;
  std::string kind;  ///< stop, emergency_stop, fault, controls_lost, armed, neutral
  std::string text;  ///< the faults' names; empty: the kind says it
  std::string axis;  ///< that a limit was exceeded on; empty: none
};

/// What began in a tick.
/// @param before the tick before it in the recording; null where it is the first
[[nodiscard]] std::vector<RecordingMark> marksOf(const TickRecord& record, const TickRecord* before,
                                                 const RecordingMeta& meta);

}  // namespace wholehand
