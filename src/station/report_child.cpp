#include "station/report_child.hpp"

#include "runtime/interrupt_scope.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
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
/// A process that was killed and waits for a disk stays; it is left to itself.
constexpr auto kGoneWithin = std::chrono::milliseconds(500);
constexpr int kNicest = 19;
// linux/ioprio.h, which not every system has: of one process, the class "idle".
constexpr int kOfProcess = 1, kIdle = 3 << 13;

void lowerPriority(pid_t child) {
  ::setpriority(PRIO_PROCESS, static_cast<id_t>(child), kNicest);
  ::syscall(SYS_ioprio_set, kOfProcess, child, kIdle);
}

// 0 or an errno.
int spawn(const std::string& program, std::string in, std::string out, pid_t& child) {
  std::string name = program, verb = "report", flag = "--out";
  char* arguments[] = {name.data(), verb.data(), in.data(), flag.data(), out.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addclosefrom_np(&actions, 3);  // neither sockets nor the recording
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;  // our threads keep signals from themselves (InterruptScope)
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  const int error = posix_spawn(&child, program.c_str(), &actions, &attributes, arguments, environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

bool isOver(pid_t child, int& status) {
  const pid_t waited = ::waitpid(child, &status, WNOHANG);
  return waited == child || (waited < 0 && errno != EINTR);
}

}  // namespace

Expected<Done> ReportChild::make(const std::string& recording, const std::string& folder) {
  const auto refusal = [&](std::string problem) {
    return Diagnostic{recording,
                      0,
                      "",
                      "",
                      std::move(problem),
                      "try: wholehand report " + recording + " --out " + folder};
  };
  const auto ends = [this] { return ending_.load() || InterruptScope::interrupted(); };
  if (ends()) return refusal("no report is made: the program is ending");
  pid_t child = 0;
  if (const int error =
          spawn(program_.empty() ? "/proc/self/exe" : program_, recording, folder, child);
      error != 0) {
    return refusal(std::string("no report could be made: ") + std::strerror(error));
  }
  lowerPriority(child);
  int status = 0;
  const auto until = Clock::now() + longest_;
  while (!isOver(child, status)) {
    if (const bool late = Clock::now() > until; late || ends()) {
      ::kill(child, SIGKILL);
      for (const auto gone = Clock::now() + kGoneWithin; Clock::now() < gone;) {
        if (isOver(child, status)) break;
        std::this_thread::sleep_for(kLook);
      }
      return refusal(late ? "no report was made in time"
                          : "no report is made: the program is ending");
    }
    std::this_thread::sleep_for(kLook);
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) return refusal("no report could be made");
  return Done{};
}

}  // namespace wholehand
