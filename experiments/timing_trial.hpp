#pragma once

#include "assembly/engines.hpp"
#include "assembly/models.hpp"
#include "assembly/run.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

struct TimingPlan {
  ModelFiles
      files;  ///< with an exercise its first dispenser is gripped, else the scene's first body
  std::string engine = defaultEngine();
  std::uint64_t ticks = 100000;
  bool simulated_clock = false;  ///< as fast as it goes: CPU time alone
  std::string folder;            ///< for the recording
  std::function<void(const TickSummary&, double rate_hz)> status;
  /// Allocations of the calling thread so far (realtime/allocation_counter.hpp); null: not counted.
  std::uint64_t (*count_allocations)() noexcept = nullptr;
};

/// The paper's Fig. 6: time of the loop while a cylinder of the exercise is grasped, squeezed
/// through the exercise's walls, released and grasped again, and every joint moves.
struct TimingResult {
  RunOutcome outcome;
  std::vector<std::uint64_t> wall_counts;  ///< ticks per bin of kTimingBin_us, wall clock
  std::vector<std::uint64_t> cpu_counts;   ///< the same of CPU time
  std::string gripped;                     ///< name of the body
  int grasps = 0;                          ///< times the grip rose above 5 N
  int releases = 0;                        ///< times it fell below 1 N again
  std::uint64_t held_ticks = 0;            ///< with a grip of more than 1 N since it was 5 N
  std::uint64_t wall_ticks = 0;            ///< with an exercise whose walls are felt
  std::vector<double> joint_travel;        ///< range of every joint [m or rad]
};

inline constexpr double kTimingBin_us = 10.0;
inline constexpr int kTimingBins = 200;  ///< the last holds everything beyond

[[nodiscard]] Expected<TimingResult> runTiming(const TimingPlan& plan);

}  // namespace wholehand
