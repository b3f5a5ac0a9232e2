#pragma once

#include "rig/engines.hpp"
#include "rig/models.hpp"
#include "rig/run/run.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

struct TimingPlan {
  ModelFiles files;  ///< with an exercise, its first dispenser is gripped; otherwise the scene's
                     ///< first body
  std::string engine = defaultEngine();
  std::uint64_t ticks = 100000;
  bool simulated_clock = false;  ///< runs as fast as possible: only CPU time is measured
  std::string folder;            ///< folder for the recording
  std::function<void(const TickSummary&, double rate_hz)> status;
  /// Counts the calling thread's allocations (loop/realtime/allocation_counter.hpp); null: not
  /// counted.
  std::uint64_t (*count_allocations)() noexcept = nullptr;
};

/// Result of the paper's Fig. 6: loop times while a cylinder of the exercise is grasped, squeezed
/// through the exercise's walls, released and grasped again, with all joints moving.
struct TimingResult {
  RunOutcome outcome;
  std::vector<std::uint64_t> wall_counts;  ///< ticks per bin of kTimingBin_us, wall clock
  std::vector<std::uint64_t> cpu_counts;   ///< ticks per bin, CPU time
  std::string gripped;                     ///< name of the body
  int grasps = 0;                          ///< number of times the grip force rose above 5 N
  int releases = 0;                        ///< number of times it then fell below 1 N
  std::uint64_t held_ticks = 0;            ///< ticks during these grips
  Percentiles held_cpu;                    ///< CPU time of these ticks
  std::uint64_t wall_ticks = 0;            ///< ticks with rendered exercise walls
  std::vector<double> joint_travel;        ///< range of motion of every joint [m or rad]
};

inline constexpr double kTimingBin_us = 10.0;
inline constexpr int kTimingBins = 200;  ///< the last bin is open-ended

[[nodiscard]] Expected<TimingResult> runTiming(const TimingPlan& plan);

}  // namespace wholehand
