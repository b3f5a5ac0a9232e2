#include "files/process/child_process.hpp"

#include "loop/core/compiler.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <ctime>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <string>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

extern char** environ;  // NOLINT(readability-identifier-naming): POSIX

/// Starting and ending child processes.
namespace wholehand::process {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLookAtEnd = std::chrono::milliseconds(1);
/// A killed process in uninterruptible disk sleep does not end; it is abandoned after this time.
constexpr auto kGoneWithin = std::chrono::milliseconds(500);
// Scope "process" and class "idle" from linux/ioprio.h, a header that some systems lack.
constexpr int kOfProcess = 1, kIdle = 3 << 13;

/// Limits a running child's resources and disables its core dump. The child keeps this process's
/// CPU priority, because a user waits for its result; a loop that moves a person runs at real-time
/// priority and is not delayed (ADR 27).
/// @param idle_disk lowest disk priority
void limit(pid_t child, std::uint64_t memory_bytes, bool idle_disk) {
  // A sanitizer's shadow memory exceeds any limit. The sanitizer disables the core dump itself, and
  // it ends the child if this process does so at the same moment and makes that fail.
  if (WHOLEHAND_SANITIZED == 0) {
    const rlimit memory{memory_bytes, memory_bytes}, no_core{0, 0};
    (void)::prlimit(child, RLIMIT_AS, &memory, nullptr);
    (void)::prlimit(child, RLIMIT_CORE, &no_core, nullptr);
  }
  if (idle_disk) (void)::syscall(SYS_ioprio_set, kOfProcess, child, kIdle);
}

/// Starts a program without file descriptors other than the standard ones and without blocked
/// signals. Uses posix_spawn instead of fork, so that the pages of a running loop are not marked
/// copy-on-write. Returns 0 or an errno.
/// @param input, output descriptors of its standard input and output; -1: inherited
int spawn(const std::string& program, std::vector<std::string> arguments, int input, int output,
          pid_t& child) {
  std::string name = program;
  std::vector<char*> words = {name.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (input >= 0) posix_spawn_file_actions_adddup2(&actions, input, STDIN_FILENO);
  if (output >= 0) posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions,
                                           3);  // closes sockets and the recording in the child
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;  // threads of this program block signals (InterruptScope)
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const int error =
      posix_spawn(&child, program.c_str(), &actions, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

/// Processor time of a child that was not reaped; 0: unknown.
std::chrono::milliseconds processorTime(pid_t child) {
  clockid_t clock = 0;
  timespec now{};
  if (::clock_getcpuclockid(child, &clock) != 0 || ::clock_gettime(clock, &now) != 0) return {};
  return std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec));
}

/// True when the child has ended; reaps it.
bool isOver(pid_t child, int& status) {
  const pid_t waited = ::waitpid(child, &status, WNOHANG);
  return waited == child || (waited < 0 && errno != EINTR);
}

/// Kills the child and reaps it. A child that hangs in disk I/O is abandoned after 0.5 s.
void kill(pid_t child) {
  int status = 0;
  ::kill(child, SIGKILL);
  for (const auto gone = Clock::now() + kGoneWithin; Clock::now() < gone;) {
    if (isOver(child, status)) return;
    std::this_thread::sleep_for(kLookAtEnd);
  }
}

}  // namespace
}  // namespace wholehand::process

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

/// Waits at most kLook for output and reads it. Returns false at the end of the output.
bool takeOutput(int from, std::string& output) {
  pollfd ready{from, POLLIN, 0};
  if (::poll(&ready, 1, static_cast<int>(kLook.count())) <= 0) return true;
  std::array<char, 65536> bytes;  // NOLINT: read() fills it
  const ssize_t n = ::read(from, bytes.data(), bytes.size());
  if (n > 0) output.append(bytes.data(), n);
  return n > 0 || (n < 0 && errno == EINTR);
}

constexpr int kLook_ms = 20;
/// Time limit for the child's exit after it closed its socket.
constexpr auto kEndsWithin = std::chrono::seconds(10);
constexpr std::size_t kPiece_bytes = 1 << 16;

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
  process::limit(child, limits.memory_bytes, limits.idle_disk);
  pipe.closeEnd(1);
  const auto until = Clock::now() + limits.time;
  const auto ended = [&](ChildEnding how) {
    process::kill(child);
    return ChildResult{how, 0, {}, result.processor_time};
  };
  for (int status = 0;;) {
    result.processor_time = std::max(result.processor_time, process::processorTime(child));
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
    if (Clock::now() > until || result.processor_time > limits.processor_time) {
      return ended(ChildEnding::kLate);
    }
  }
}

std::unique_ptr<TalkingChild> TalkingChild::start(const std::string& program,
                                                  const std::vector<std::string>& arguments,
                                                  const Limits& limits) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) return nullptr;
  pid_t child = 0;
  const int error = process::spawn(program, arguments, ends[1], ends[1], child);
  ::close(ends[1]);
  if (error != 0) {
    ::close(ends[0]);
    errno = error;
    return nullptr;
  }
  process::limit(child, limits.memory_bytes, limits.idle_disk);
  return std::unique_ptr<TalkingChild>(new TalkingChild(child, ends[0]));
}

TalkingChild::~TalkingChild() {
  ::close(socket_);
  if (!over_) process::kill(child_);
}

bool TalkingChild::send(std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) hung_up_ = true;
    if (n <= 0) return false;
    text.remove_prefix(n);
  }
  return true;
}

std::string TalkingChild::receive(std::size_t bytes, Clock::time_point until,
                                  const std::function<bool()>& stop) {
  std::string said;
  while (said.size() < bytes && Clock::now() < until && !(stop && stop())) {
    pollfd ready{socket_, POLLIN, 0};
    if (::poll(&ready, 1, kLook_ms) <= 0) continue;
    const std::size_t at = said.size();
    said.resize(at + std::min(bytes - at, kPiece_bytes));
    const ssize_t n = ::recv(socket_, said.data() + at, said.size() - at, 0);
    said.resize(at + std::max<ssize_t>(n, 0));
    hung_up_ = n == 0 || (n < 0 && errno != EINTR);
    if (hung_up_) break;
  }
  return said;
}

int TalkingChild::signal() {
  if (!hung_up_) return 0;
  for (const auto until = Clock::now() + kEndsWithin; !over_ && Clock::now() < until;) {
    over_ = process::isOver(child_, status_);
    if (!over_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return over_ && WIFSIGNALED(status_) ? WTERMSIG(status_) : 0;
}

}  // namespace wholehand
