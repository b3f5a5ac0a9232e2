#pragma once

#include <chrono>
#include <cstdint>
#include <thread>

namespace wholehand::moteus {

/// Clock of the driver; tests replace it.
class BusClock {
 public:
  virtual ~BusClock() = default;
  [[nodiscard]] virtual std::int64_t now_ns() noexcept = 0;
  /// Waits a tenth of a millisecond or slightly more. Never in the tick.
  virtual void rest() = 0;
};

/// CLOCK_MONOTONIC.
class MonotonicClock final : public BusClock {
 public:
  [[nodiscard]] std::int64_t now_ns() noexcept override {
    return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1);
  }
  void rest() override { std::this_thread::sleep_for(std::chrono::microseconds(100)); }
};

}  // namespace wholehand::moteus
