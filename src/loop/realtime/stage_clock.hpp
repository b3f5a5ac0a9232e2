#pragma once

#include "loop/core/tick_record.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <array>
#include <cstdint>

namespace wholehand {

/// Duration of a tick. The stages sum to at most cpu_ns; the rest ran after the last lap or is the
/// cost of the clock itself.
struct StageTimes {
  std::int64_t wall_ns = 0;  ///< from start() to finish() on the wall clock
  std::int64_t cpu_ns = 0;   ///< CPU time that the thread used meanwhile
  std::array<std::int32_t, kStages> stage_cpu_ns{};
};

/// Subtracts preemption (`excess_ns`: wall time beyond the CPU time) from the laps, longest lap
/// first, until the laps are CPU times. A preemption falls into one stage; one that is long enough
/// to matter makes that stage the longest. Scaling all laps would take time from the other stages.
/// Pure. Real-time safe.
inline void removePreemption(std::array<std::int64_t, kStages>& laps_ns,
                             std::int64_t excess_ns) noexcept {
  for (int round = 0; round < kStages && excess_ns > 0; ++round) {
    std::int64_t* longest = &laps_ns[0];
    for (std::int64_t& lap : laps_ns) {
      if (lap > *longest) {
        longest = &lap;
      }
    }
    const std::int64_t taken_ns = excess_ns < *longest ? excess_ns : *longest;
    *longest -= taken_ns;
    excess_ns -= taken_ns;
  }
}

/// Times the stages of a tick. The thread's CPU clock is a system call (about 360 ns on the
/// development machine; nine a tick would cost 3.2 µs), so laps are taken on the wall clock
/// (20 ns) and corrected once by the CPU time of the whole tick: two system calls, 1 µs a tick.
/// Use from one thread. Real-time safe.
class StageClock {
 public:
  /// Begins a tick and clears all laps.
  void start() noexcept {
    laps_ns_.fill(0);
    cpu_start_ns_ = threadCpuNow_ns();
    wall_start_ns_ = monotonicNow_ns();
    last_ns_ = wall_start_ns_;
  }

  /// Assigns the time since start() or the last lap to `stage`; laps of one stage add up.
  void lap(Stage stage) noexcept {
    const std::int64_t now_ns = monotonicNow_ns();
    laps_ns_[static_cast<std::size_t>(stage)] += now_ns - last_ns_;
    last_ns_ = now_ns;
  }

  /// Ends the tick. Time after the last lap counts in wall_ns and cpu_ns, but in no stage.
  /// Stages are reported in steps of 16 ns, rounded down.
  [[nodiscard]] StageTimes finish() noexcept {
    StageTimes times;
    times.wall_ns = monotonicNow_ns() - wall_start_ns_;
    times.cpu_ns = threadCpuNow_ns() - cpu_start_ns_;
    removePreemption(laps_ns_, times.wall_ns - times.cpu_ns);
    for (std::size_t i = 0; i < laps_ns_.size(); ++i) {
      const std::int64_t lap_ns = laps_ns_[i] < kMax_ns ? laps_ns_[i] : kMax_ns;
      times.stage_cpu_ns[i] = static_cast<std::int32_t>(lap_ns - lap_ns % kStep_ns);
    }
    return times;
  }

 private:
  static constexpr std::int64_t kMax_ns = 2'000'000'000;  // fits into the record's 32 bits
  static constexpr std::int64_t kStep_ns = 16;            // the clock itself takes 20 ns a lap

  std::array<std::int64_t, kStages> laps_ns_{};
  std::int64_t wall_start_ns_ = 0;
  std::int64_t cpu_start_ns_ = 0;
  std::int64_t last_ns_ = 0;
};

}  // namespace wholehand
