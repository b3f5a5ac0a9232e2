#include "process/spawn.hpp"

#include "core/sanitized.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

extern char** environ;  // NOLINT(readability-identifier-naming): POSIX

namespace wholehand::process {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLookAtEnd = std::chrono::milliseconds(1);
/// A killed process in uninterruptible disk sleep remains; it is abandoned after this time.
constexpr auto kGoneWithin = std::chrono::milliseconds(500);
constexpr int kNicest = 19;
// From linux/ioprio.h, which not every system has: scope "process", class "idle".
constexpr int kOfProcess = 1, kIdle = 3 << 13;

}  // namespace

void limit(pid_t child, std::uint64_t memory_bytes, bool idle) {
  const rlimit memory{memory_bytes, memory_bytes}, no_core{0, 0};
  // A sanitizer's shadow memory exceeds any limit.
  if (WHOLEHAND_SANITIZED == 0) (void)::prlimit(child, RLIMIT_AS, &memory, nullptr);
  (void)::prlimit(child, RLIMIT_CORE, &no_core, nullptr);
  if (!idle) return;
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(child), kNicest);
  (void)::syscall(SYS_ioprio_set, kOfProcess, child, kIdle);
}

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
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);  // neither sockets nor the recording
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;  // our threads block signals (InterruptScope)
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const int error =
      posix_spawn(&child, program.c_str(), &actions, &attributes, words.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

bool isOver(pid_t child, int& status) {
  const pid_t waited = ::waitpid(child, &status, WNOHANG);
  return waited == child || (waited < 0 && errno != EINTR);
}

void kill(pid_t child) {
  int status = 0;
  ::kill(child, SIGKILL);
  for (const auto gone = Clock::now() + kGoneWithin; Clock::now() < gone;) {
    if (isOver(child, status)) return;
    std::this_thread::sleep_for(kLookAtEnd);
  }
}

}  // namespace wholehand::process
