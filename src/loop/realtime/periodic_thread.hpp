#pragma once

#include "loop/core/expected.hpp"
#include "loop/realtime/thread_setup.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <pthread.h>

namespace wholehand {

/// The loop period that a wake-up belongs to.
struct Slot {
  std::int64_t start_ns = 0;          ///< its scheduled instant, on the loop's phase
  std::uint32_t elapsed_periods = 1;  ///< since the last tick's slot: 1 + skipped periods
};

/// Applies the overrun policy: keep the phase, never run ticks in a burst, count what was skipped.
/// A wake-up at `now_ns` belongs to the latest slot that has begun, and always to a later slot than
/// the last tick's. A slot therefore never holds two ticks, and a stall of many periods results in
/// a single tick that reports it. Pure. Real-time safe.
/// @param now_ns    time of the wake-up (any clock)
/// @param last_ns   scheduled instant of the last tick's slot, same clock
/// @param period_ns > 0
[[nodiscard]] constexpr Slot slotAt(std::int64_t now_ns, std::int64_t last_ns,
                                    std::int64_t period_ns) noexcept {
  const std::int64_t since_periods = (now_ns - last_ns) / period_ns;
  const std::int64_t elapsed =
      since_periods < 1 ? 1 : (since_periods > UINT32_MAX ? UINT32_MAX : since_periods);
  return {last_ns + elapsed * period_ns, static_cast<std::uint32_t>(elapsed)};
}

struct PeriodicThreadConfig {
  std::int64_t period_ns = 1'000'000;  ///< Range [10'000, 1'000'000'000].
  std::size_t stack_bytes = std::size_t{2}
                            << 20U;  ///< Range [64 KiB, 64 MiB]; locked with the rest.
  ThreadSetupConfig setup;
};

/// Calls a function at absolute instants on its own thread, with the real-time settings that the
/// machine grants. The clock also runs while the machine is suspended: the first tick after that is
/// late.
class PeriodicThread {
 public:
  /// One tick; false ends the loop. It must not throw: an exception here terminates the program.
  /// @param elapsed_periods 1 + periods skipped since the last tick
  /// @param lateness_ns     wake-up time minus the due instant; ≥ one period after a skip
  using Tick = std::function<bool(std::uint32_t elapsed_periods, std::int64_t lateness_ns)>;

  PeriodicThread(const PeriodicThreadConfig& config, Tick tick);
  /// Stops the loop after the current tick and joins the thread. A tick function that ramps the
  /// device down should have ended the loop before, by returning false.
  ~PeriodicThread();
  PeriodicThread(const PeriodicThread&) = delete;
  PeriodicThread& operator=(const PeriodicThread&) = delete;

  /// Creates the thread and returns once it is set up; the first tick is one period away. Call
  /// once. Fails for an invalid config, or when the system cannot create a thread.
  [[nodiscard]] Expected<SetupReport> start();
  /// Waits for the loop to end.
  void join() noexcept;
  /// True until the last tick has returned.
  [[nodiscard]] bool running() const noexcept { return running_.load(std::memory_order_acquire); }

 private:
  static void* threadMain(void* self) noexcept;
  void loop() noexcept;

  PeriodicThreadConfig config_;
  Tick tick_;
  SetupReport report_;
  pthread_t thread_{};
  bool joinable_ = false;
  std::atomic<bool> ready_{false};
  std::atomic<bool> running_{false};
  std::atomic<bool> stop_{false};
};

}  // namespace wholehand
