#pragma once

#include "assembly/rig.hpp"
#include "assembly/run.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

struct TimingPlan {
  std::uint64_t ticks = 100000;
  bool simulated_clock = false;  ///< as fast as it goes: CPU time alone
  std::string folder;            ///< for the scene and the recording
  std::function<void(const TickSummary&, double rate_hz)> status;
  /// Allocations of the calling thread so far (realtime/allocation_counter.hpp); null: not counted.
  std::uint64_t (*count_allocations)() noexcept = nullptr;
};

/// The paper's Fig. 6: time of the loop while a cylinder is grasped, released and grasped again and
/// every joint moves.
struct TimingResult {
  RunOutcome outcome;
  std::vector<std::uint64_t> wall_counts;  ///< ticks per bin of kTimingBin_us, wall clock
  std::vector<std::uint64_t> cpu_counts;   ///< the same of CPU time
  int grasps = 0;                          ///< times the grip rose above 5 N
  int releases = 0;                        ///< times it fell below 1 N again
  std::vector<double> joint_travel;        ///< range of every joint [m or rad]
};

inline constexpr double kTimingBin_us = 10.0;
inline constexpr int kTimingBins = 200;  ///< the last holds everything beyond

[[nodiscard]] Expected<TimingResult> runTiming(const ModelFiles& files, const TimingPlan& plan);

}  // namespace wholehand
