#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// What a process that reads a stranger's file may use.
struct ChildLimits {
  std::chrono::milliseconds time{10'000};   ///< from its start on
  std::uint64_t memory_bytes = 1ULL << 30;  ///< of address space; not under a sanitizer
  std::uint64_t output_bytes = 0;           ///< of its standard output; 0: it has this process's
  bool idle = false;                        ///< lowest priority of CPU and disk
};

enum class ChildEnding { kExited, kSignal, kLate, kStopped, kTooMuchOutput, kNotStarted };

struct ChildResult {
  ChildEnding ending = ChildEnding::kNotStarted;
  int code = 0;        ///< exit code, signal, or errno where it was not started
  std::string output;  ///< what it wrote to its standard output, where limits.output_bytes > 0
};

/// Runs a program and waits for its end. It gets no file but the standard ones, and no blocked
/// signals; it leaves no core. What is late, writes too much or is to stop is killed.
/// posix_spawn, no fork: the pages of a running loop are not marked for copying. Not for the tick.
/// @param stop asked every 20 ms; empty: never
[[nodiscard]] ChildResult runChild(const std::string& program,
                                   const std::vector<std::string>& arguments,
                                   const ChildLimits& limits,
                                   const std::function<bool()>& stop = {});

}  // namespace wholehand
