#pragma once

#include "core/expected.hpp"
#include "realtime/thread_setup.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <pthread.h>

namespace wholehand {

/// The period of a loop that a wake-up falls into.
struct Slot {
  std::int64_t start_ns = 0;          ///< its scheduled instant, in phase with all others
  std::uint32_t elapsed_periods = 1;  ///< since the last tick's slot: 1 + skipped periods
};

/// The overrun policy: keep the phase, never burst, count. A wake-up at `now_ns` belongs to the
/// latest slot that has begun, but always to a later one than the last tick's, so that a slot
/// never holds two ticks and a stall of many periods is answered by one tick that says so.
/// Pure. Real-time safe.
/// @param now_ns    when the thread woke up (any clock)
/// @param last_ns   the scheduled instant of the last tick's slot, same clock
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

/// Calls a function at absolute instants of the monotonic clock, from a thread of its own that is
/// set up for real time as far as this machine grants it.
class PeriodicThread {
 public:
  /// One tick; false ends the loop. It must not throw: an exception here ends the program.
  /// @param elapsed_periods 1 + periods skipped since the last tick
  /// @param lateness_ns     wake-up after the instant that was due next; ≥ one period after a skip
  using Tick = std::function<bool(std::uint32_t elapsed_periods, std::int64_t lateness_ns)>;

  PeriodicThread(const PeriodicThreadConfig& config, Tick tick);
  /// Stops the loop after the tick that runs (a tick that ramps down should have returned false
  /// before) and joins.
  ~PeriodicThread();
  PeriodicThread(const PeriodicThread&) = delete;
  PeriodicThread& operator=(const PeriodicThread&) = delete;

  /// Creates the thread and returns once it is set up: the first tick is one period away. To be
  /// called once. Fails for a bad config or where the system gives no thread.
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
