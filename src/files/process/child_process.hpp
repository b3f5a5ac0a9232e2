#pragma once

#include "loop/core/expected.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <sys/types.h>
#include <vector>

namespace wholehand {

/// Resource limits of a process that reads an untrusted file.
struct ChildLimits {
  std::chrono::milliseconds time{10'000};  ///< measured from the child's start
  std::chrono::milliseconds processor_time = std::chrono::milliseconds::max();  ///< of the child
  std::uint64_t memory_bytes = 1ULL << 30;  ///< address space; not enforced under a sanitizer
  std::uint64_t output_bytes = 0;           ///< captured standard output; 0: it inherits this
                                            ///< process's output
  bool idle_disk = false;                   ///< lowest disk priority
};

/// kLate: beyond its time or its processor time.
enum class ChildEnding { kExited, kSignal, kLate, kStopped, kTooMuchOutput, kNotStarted };

struct ChildResult {
  ChildEnding ending = ChildEnding::kNotStarted;
  int code = 0;        ///< exit code, signal, or errno if it did not start
  std::string output;  ///< captured standard output if limits.output_bytes > 0
  std::chrono::milliseconds processor_time{0};  ///< of the child, when last seen
};

/// Runs a program and waits for its end. The child gets no file descriptors except the standard
/// ones, no blocked signals, and writes no core dump. It is killed when it exceeds a time or its
/// output, or when `stop` returns true. Uses posix_spawn instead of fork, so that the pages of a
/// running loop are not marked copy-on-write. Not real-time safe.
/// @param stop polled every 20 ms; empty: never
[[nodiscard]] ChildResult runChild(const std::string& program,
                                   const std::vector<std::string>& arguments,
                                   const ChildLimits& limits,
                                   const std::function<bool()>& stop = {});

/// A child process that answers repeated requests. Its standard input and output are one socket to
/// this process; the child ends when the socket closes. Descriptors, signals and core dumps are
/// handled as in runChild(). For one thread at a time.
class TalkingChild {
 public:
  struct Limits {
    std::uint64_t memory_bytes = 1ULL << 30;  ///< address space; not enforced under a sanitizer
    bool idle_disk = false;                   ///< lowest disk priority
  };

  /// Starts the child. Returns null and sets errno when that fails.
  [[nodiscard]] static std::unique_ptr<TalkingChild> start(
      const std::string& program, const std::vector<std::string>& arguments, const Limits& limits);
  /// Kills the child.
  ~TalkingChild();
  TalkingChild(const TalkingChild&) = delete;
  TalkingChild& operator=(const TalkingChild&) = delete;

  /// Sends the whole text; returns false when the child has ended.
  [[nodiscard]] bool send(std::string_view text);
  /// Receives `bytes` bytes; fewer when the child ended, the time `until` passed, or `stop`
  /// returned true.
  /// @param stop polled every 20 ms; empty: never
  [[nodiscard]] std::string receive(std::size_t bytes, std::chrono::steady_clock::time_point until,
                                    const std::function<bool()>& stop = {});
  /// Signal that ended the child, after send() or receive() failed; 0: none.
  [[nodiscard]] int signal();

 private:
  TalkingChild(pid_t child, int socket) : child_(child), socket_(socket) {}

  pid_t child_;
  int socket_;
  bool hung_up_ = false;  ///< the child closed its end of the socket
  bool over_ = false;     ///< the child was reaped
  int status_ = 0;
};

}  // namespace wholehand
