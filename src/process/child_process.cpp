#include "process/child_process.hpp"

#include "process/spawn.hpp"

#include <array>
#include <cerrno>
#include <cstddef>
#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace wholehand {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLook = std::chrono::milliseconds(20);
constexpr auto kLookAtEnd = std::chrono::milliseconds(1);

class Pipe {
 public:
  Pipe() = default;
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  ~Pipe() {
    closeEnd(0);
    closeEnd(1);
  }
  [[nodiscard]] bool open() { return ::pipe2(ends_.data(), O_CLOEXEC) == 0; }
  [[nodiscard]] int in() const { return ends_[1]; }
  [[nodiscard]] int out() const { return ends_[0]; }
  void closeEnd(std::size_t i) {
    if (ends_.at(i) >= 0) ::close(ends_.at(i));
    ends_.at(i) = -1;
  }

 private:
  std::array<int, 2> ends_ = {-1, -1};
};

/// Waits at most kLook for output and reads it. False at the end of the output.
bool takeOutput(int from, std::string& output) {
  pollfd ready{from, POLLIN, 0};
  if (::poll(&ready, 1, static_cast<int>(kLook.count())) <= 0) return true;
  std::array<char, 65536> bytes;  // NOLINT: read() fills it
  const ssize_t n = ::read(from, bytes.data(), bytes.size());
  if (n > 0) output.append(bytes.data(), n);
  return n > 0 || (n < 0 && errno == EINTR);
}

}  // namespace

ChildResult runChild(const std::string& program, const std::vector<std::string>& arguments,
                     const ChildLimits& limits, const std::function<bool()>& stop) {
  ChildResult result;
  Pipe pipe;
  bool listening = limits.output_bytes > 0;
  if (listening && !pipe.open()) return {ChildEnding::kNotStarted, errno, {}};
  pid_t child = 0;
  if (const int error = process::spawn(program, arguments, -1, pipe.in(), child); error != 0) {
    return {ChildEnding::kNotStarted, error, {}};
  }
  process::limit(child, limits.memory_bytes, limits.idle);
  pipe.closeEnd(1);
  const auto until = Clock::now() + limits.time;
  const auto ended = [&](ChildEnding how) {
    process::kill(child);
    return ChildResult{how, 0, {}};
  };
  for (int status = 0;;) {
    if (listening) {
      listening = takeOutput(pipe.out(), result.output);
      if (result.output.size() > limits.output_bytes) return ended(ChildEnding::kTooMuchOutput);
    } else if (process::isOver(child, status)) {
      const bool killed = WIFSIGNALED(status);
      result.ending = killed ? ChildEnding::kSignal : ChildEnding::kExited;
      result.code = killed ? WTERMSIG(status) : WEXITSTATUS(status);
      return result;
    } else {
      std::this_thread::sleep_for(limits.output_bytes > 0 ? kLookAtEnd : kLook);
    }
    if (stop && stop()) return ended(ChildEnding::kStopped);
    if (Clock::now() > until) return ended(ChildEnding::kLate);
  }
}

}  // namespace wholehand
