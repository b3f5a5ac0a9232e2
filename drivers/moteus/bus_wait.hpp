#pragma once

#include "bus_clock.hpp"
#include "can_bus.hpp"

#include <cstdint>

namespace wholehand::moteus {

/// Receives until `take(frame)` returns a value, and returns it; empty on timeout or when the bus
/// fails. Never in the tick.
template <class Take>
auto receiveUntil(CanBus& bus, BusClock& clock, std::int64_t wait_ns, Take take)
    -> decltype(take(CanFrame{})) {
  const std::int64_t until_ns = clock.now_ns() + wait_ns;
  while (clock.now_ns() < until_ns) {
    CanFrame frame;
    const BusResult result = bus.receive(frame);
    if (result == BusResult::kFailed) return {};
    if (result == BusResult::kNothing) {
      clock.rest();
      continue;
    }
    if (auto taken = take(frame)) return taken;
  }
  return {};
}

}  // namespace wholehand::moteus
