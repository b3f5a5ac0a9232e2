#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Resource limits of a process that reads an untrusted file.
struct ChildLimits {
  std::chrono::milliseconds time{10'000};   ///< from its start
  std::uint64_t memory_bytes = 1ULL << 30;  ///< address space; not enforced under a sanitizer
  std::uint64_t output_bytes = 0;           ///< captured standard output; 0: it inherits this
                                            ///< process's output
  bool idle = false;                        ///< lowest CPU and disk priority
};

enum class ChildEnding { kExited, kSignal, kLate, kStopped, kTooMuchOutput, kNotStarted };

struct ChildResult {
  ChildEnding ending = ChildEnding::kNotStarted;
  int code = 0;        ///< exit code, signal, or errno if it did not start
  std::string output;  ///< captured standard output if limits.output_bytes > 0
};

/// Runs a program and waits for its end. The child gets no file descriptors except the standard
/// ones, no blocked signals, and writes no core dump. It is killed when it exceeds its time or
/// output, or when `stop` returns true. Uses posix_spawn instead of fork, so that the pages of a
/// running loop are not marked copy-on-write. Not for the tick.
/// @param stop polled every 20 ms; empty: never
[[nodiscard]] ChildResult runChild(const std::string& program,
                                   const std::vector<std::string>& arguments,
                                   const ChildLimits& limits,
                                   const std::function<bool()>& stop = {});

}  // namespace wholehand
