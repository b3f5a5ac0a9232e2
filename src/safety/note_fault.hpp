#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

namespace wholehand {

/// Adds faults to the tick's. fault_axis becomes the axis of the first fault that stops the run, -1
/// if that fault has no axis; without such a fault, the first axis that was limited.
/// @param axis of the faults; -1: none. Real-time safe.
WHOLEHAND_RT inline void noteFault(Fault faults, int axis, TickRecord& record) noexcept {
  const bool stopped = any(record.faults & kStoppingFaults);
  const bool stops = any(faults & kStoppingFaults);
  if (!stopped && (stops || record.fault_axis < 0)) record.fault_axis = axis;
  record.faults |= faults;
}

}  // namespace wholehand
