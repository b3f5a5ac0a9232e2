#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"

namespace wholehand {

/// Adds faults to the tick's. Its fault_axis is that of the first fault that stops the run, -1
/// where this one is of no axis; without such a fault, the first axis that was limited.
/// @param axis of the faults; -1: of none. Real-time safe.
WHOLEHAND_RT inline void noteFault(Fault faults, int axis, TickRecord& record) noexcept {
  const bool stopped = any(record.faults & kStopping);
  const bool stops = any(faults & kStopping);
  if (!stopped && (stops || record.fault_axis < 0)) record.fault_axis = axis;
  record.faults |= faults;
}

}  // namespace wholehand
