#include "process/child_process.hpp"

#include "realtime/sanitized.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

extern char** environ;  // NOLINT(readability-identifier-naming): POSIX

namespace wholehand {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLook = std::chrono::milliseconds(20);
constexpr auto kLookAtEnd = std::chrono::milliseconds(1);
/// A process that was killed and waits for a disk stays; it is left to itself.
constexpr auto kGoneWithin = std::chrono::milliseconds(500);
constexpr int kNicest = 19;
// linux/ioprio.h, which not every system has: of one process, the class "idle".
constexpr int kOfProcess = 1, kIdle = 3 << 13;

void limit(pid_t child, const ChildLimits& limits) {
  const rlimit memory{limits.memory_bytes, limits.memory_bytes}, no_core{0, 0};
  // A sanitizer's shadow alone is larger than any limit.
  if (WHOLEHAND_SANITIZED == 0) (void)::prlimit(child, RLIMIT_AS, &memory, nullptr);
  (void)::prlimit(child, RLIMIT_CORE, &no_core, nullptr);
  if (!limits.idle) return;
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(child), kNicest);
  (void)::syscall(SYS_ioprio_set, kOfProcess, child, kIdle);
}

/// 0 or an errno.
/// @param output where its standard output goes; -1: where this process's goes
int spawn(const std::string& program, std::vector<std::string> arguments, int output,
          pid_t& child) {
  std::string name = program;
  std::vector<char*> words = {name.data()};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  if (output >= 0) posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);  // neither sockets nor the recording
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;  // our threads keep signals from themselves (InterruptScope)
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const int error =
      posix_spawn(&child, program.c_str(), &actions, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

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

/// Waits at most kLook for output and takes what is there. False once there will be none.
bool takeOutput(int from, std::string& output) {
  pollfd ready{from, POLLIN, 0};
  if (::poll(&ready, 1, static_cast<int>(kLook.count())) <= 0) return true;
  std::array<char, 65536> bytes;  // NOLINT: read() fills it
  const ssize_t n = ::read(from, bytes.data(), bytes.size());
  if (n > 0) output.append(bytes.data(), static_cast<std::size_t>(n));
  return n > 0 || (n < 0 && errno == EINTR);
}

bool isOver(pid_t child, int& status) {
  const pid_t waited = ::waitpid(child, &status, WNOHANG);
  return waited == child || (waited < 0 && errno != EINTR);
}

void end(pid_t child) {
  int status = 0;
  ::kill(child, SIGKILL);
  for (const auto gone = Clock::now() + kGoneWithin; Clock::now() < gone;) {
    if (isOver(child, status)) return;
    std::this_thread::sleep_for(kLookAtEnd);
  }
}

}  // namespace

ChildResult runChild(const std::string& program, const std::vector<std::string>& arguments,
                     const ChildLimits& limits, const std::function<bool()>& stop) {
  ChildResult result;
  Pipe pipe;
  bool listening = limits.output_bytes > 0;
  if (listening && !pipe.open()) return {ChildEnding::kNotStarted, errno, {}};
  pid_t child = 0;
  if (const int error = spawn(program, arguments, pipe.in(), child); error != 0) {
    return {ChildEnding::kNotStarted, error, {}};
  }
  limit(child, limits);
  pipe.closeEnd(1);
  const auto until = Clock::now() + limits.time;
  const auto ended = [&](ChildEnding how) {
    end(child);
    return ChildResult{how, 0, {}};
  };
  for (int status = 0;;) {
    if (listening) {
      listening = takeOutput(pipe.out(), result.output);
      if (result.output.size() > limits.output_bytes) return ended(ChildEnding::kTooMuchOutput);
    } else if (isOver(child, status)) {
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
