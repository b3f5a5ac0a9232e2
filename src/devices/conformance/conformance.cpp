#include "devices/conformance/conformance.hpp"

#include "loop/core/compiler.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <optional>
#include <poll.h>
#include <string>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace wholehand {
namespace {

constexpr rlim_t kMostMemory_bytes = rlim_t{16} << 30U;
constexpr int kLookEvery_ms = 20;
constexpr int kAttempts = 3;
constexpr int kReady = 99;  // exit code of a child that has run all checks

/// Message of the child; shorter than PIPE_BUF, so that it is written atomically.
struct Message {
  std::uint32_t check;
  std::uint32_t begins;  ///< 1: the check begins; 0: this is its result
  std::uint32_t outcome;
  char text[500];
};
static_assert(sizeof(Message) <= 4096);

void send(int pipe, pid_t self, const Message& message) {
  if (::getpid() != self) ::_exit(1);  // a child process forked by the driver
  if (::write(pipe, &message, sizeof(message)) != sizeof(message)) ::_exit(1);
}

void limit(int what, rlim_t value) {
  const rlimit both{value, value};
  (void)::setrlimit(what, &both);
}

// Runs a check. A stall of this machine between two commands triggers the watchdog, so a check that
// failed then is repeated. If the machine stalls every time, the check is skipped.
CheckFinding lookAt(DriverBench& bench, const Check& check) {
  CheckFinding finding;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (std::string why = bench.reach(check.before); !why.empty()) return skipped(std::move(why));
    finding = check.look(bench);
    const bool judged = finding.outcome != Outcome::kFailed || !bench.stalled();
    bench.disableAtNeutral();
    if (judged || check.before != DriverStage::kEnabled) return finding;
  }
  return skipped("this machine stood still between two commands: " + finding.text);
}

[[noreturn]] void carryOut(const DriverLocation& driver, const std::vector<KnownAxis>& known,
                           const std::vector<const Check*>& checks, int pipe) {
  const pid_t self = ::getpid();
  (void)::setpgid(0, 0);
  (void)::prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Resets the signal handlers, so that the driver runs without this program's handlers, including
  // crash handlers.
  for (const int signal :
       {SIGPIPE, SIGINT, SIGTERM, SIGSEGV, SIGBUS, SIGABRT, SIGFPE, SIGILL, SIGTRAP, SIGSYS}) {
    std::signal(signal, SIG_DFL);
  }
  limit(RLIMIT_CORE, 0);
  if (!WHOLEHAND_SANITIZED) limit(RLIMIT_AS, kMostMemory_bytes);  // sanitizers reserve far more
  (void)::dup2(STDERR_FILENO, STDOUT_FILENO);  // keeps the driver's printf out of the results
  {
    DriverBench bench(driver, known);
    for (std::size_t i = 0; i < checks.size(); ++i) {
      Message message{static_cast<std::uint32_t>(i), 1, 0, {}};
      send(pipe, self, message);
      bench.onAlive([&] { send(pipe, self, message); });
      const CheckFinding finding = lookAt(bench, *checks[i]);
      message.begins = 0;
      message.outcome = static_cast<std::uint32_t>(finding.outcome);
      std::strncpy(message.text, finding.text.c_str(), sizeof(message.text) - 1);
      send(pipe, self, message);
    }
  }
  ::_exit(kReady);
}

/// The parent's side of one child.
class GroupProcess {
 public:
  GroupProcess(pid_t child, int pipe, std::size_t checks, double longest_check_s)
      : child_(child),
        pipe_(pipe),
        longest_ns_(static_cast<std::int64_t>(longest_check_s * 1e9)),
        findings_(checks, skipped({})) {}

  std::vector<CheckFinding> follow() {
    std::int64_t heard_ns = monotonicNow_ns();
    int status = 0;
    std::string end;
    while (end.empty()) {
      const bool over = ::waitpid(child_, &status, WNOHANG) == child_;
      if (drain()) heard_ns = monotonicNow_ns();
      if (over) {
        end = describeEnd(status);
      } else if (monotonicNow_ns() - heard_ns > longest_ns_) {
        end = stop();
      }
    }
    (void)::kill(-child_, SIGKILL);  // also kills the driver's child processes
    ::close(pipe_);
    if (end != "done") blame(end);
    return std::move(findings_);
  }

 private:
  // Reads the pending messages; true if there were any.
  bool drain() {
    bool any = false;
    pollfd readable{pipe_, POLLIN, 0};
    Message message{};
    for (int wait_ms = kLookEvery_ms; ::poll(&readable, 1, wait_ms) == 1; wait_ms = 0) {
      if (::read(pipe_, &message, sizeof(message)) != sizeof(message)) break;
      take(message);
      any = true;
    }
    return any;
  }
  void take(const Message& message) {
    if (message.check >= findings_.size()) return;
    under_way_ = message.begins != 0 ? std::optional<std::size_t>(message.check) : std::nullopt;
    reached_ = message.check;
    if (message.begins != 0) return;
    findings_[message.check] = {
        static_cast<Outcome>(message.outcome),
        std::string(message.text, ::strnlen(message.text, sizeof(message.text)))};
  }
  std::string stop() {
    (void)::kill(-child_, SIGKILL);
    (void)::kill(child_, SIGKILL);
    (void)::waitpid(child_, nullptr, 0);
    return "the driver hangs: no answer for " + number(static_cast<double>(longest_ns_) * 1e-9) +
           " s";
  }
  static std::string describeEnd(int status) {
    if (WIFEXITED(status) && WEXITSTATUS(status) == kReady) return "done";
    if (WIFSIGNALED(status)) {
      return std::string("the driver ended the process: ") + ::strsignal(WTERMSIG(status));
    }
    return "the driver ended the process with exit code " + std::to_string(WEXITSTATUS(status));
  }
  // Assigns the failure to a check. A driver that dies when the device is closed at the end fails
  // the last check.
  void blame(const std::string& end) {
    const std::size_t at = under_way_.value_or(reached_);
    findings_[at] = failed(under_way_ ? end : end + ", when the device was closed at the end");
    for (std::size_t i = at + 1; i < findings_.size(); ++i) {
      findings_[i] = skipped("the process of this group was gone");
    }
  }

  pid_t child_;
  int pipe_;
  std::int64_t longest_ns_;
  std::vector<CheckFinding> findings_;
  std::optional<std::size_t> under_way_;
  std::size_t reached_ = 0;
};

/// Runs checks in a child process, in order, and returns a finding for each. If the child dies or a
/// check exceeds `longest_check_s`, the current check fails and the rest are not run. Processes
/// that the driver leaves behind are killed.
std::vector<CheckFinding> runInProcess(const DriverLocation& driver,
                                       const std::vector<KnownAxis>& known,
                                       const std::vector<const Check*>& checks,
                                       double longest_check_s) {
  std::array<int, 2> ends{};
  const auto impossible = [&](const char* what) {
    return std::vector<CheckFinding>(checks.size(),
                                     skipped(std::string(what) + ": " + std::strerror(errno)));
  };
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return impossible("no pipe");
  std::fflush(nullptr);  // otherwise the child prints the buffered text again
  const pid_t child = ::fork();
  if (child < 0) return impossible("no process");
  if (child == 0) {
    ::close(ends[0]);
    carryOut(driver, known, checks, ends[1]);
  }
  (void)::setpgid(child, child);  // called in parent and child, because either may run first
  ::close(ends[1]);
  return GroupProcess(child, ends[0], checks.size(), longest_check_s).follow();
}

// Reason why a check is left out; empty: it runs.
std::string whyLeftOut(const Check& check, const ConformanceOptions& options) {
  if (check.effect == Effect::kLooks) return {};
  if (!options.allow_effort) return "moves the device: --allow-effort, with nobody attached";
  if (check.effect == Effect::kOverreaches && !options.allow_beyond_limit) {
    return "asks for more than the limit: --allow-beyond-limit, with the device held or free";
  }
  return {};
}

bool isAskedFor(const Check& check, const std::string& only) {
  return std::string(check.id).compare(0, only.size(), only) == 0;
}

}  // namespace

std::span<const CheckGroup> checkGroups() {
  static const std::array<CheckGroup, 9> kGroups = {{{"boundary", boundaryChecks()},
                                                     {"description", descriptionChecks()},
                                                     {"lifecycle", lifecycleChecks()},
                                                     {"samples", sampleChecks()},
                                                     {"commands", commandChecks()},
                                                     {"motion", motionChecks()},
                                                     {"time", timeChecks()},
                                                     {"watchdog", watchdogChecks()},
                                                     {"faults", faultChecks()}}};
  return kGroups;
}

std::vector<CheckResult> conform(const ConformanceOptions& options) {
  std::vector<CheckResult> out;
  for (const CheckGroup& group : checkGroups()) {
    std::vector<CheckResult> results;
    std::vector<std::size_t> to_run;
    for (const Check& check : group.checks) {
      if (!isAskedFor(check, options.only)) continue;
      const std::string left_out = whyLeftOut(check, options);
      if (left_out.empty()) to_run.push_back(results.size());
      results.push_back({&check, skipped(left_out)});
    }
    std::vector<const Check*> checks;
    for (const std::size_t i : to_run) checks.push_back(results[i].check);
    if (checks.empty()) {
      out.insert(out.end(), results.begin(), results.end());
      continue;
    }
    const std::vector<CheckFinding> findings =
        runInProcess(options.driver, options.known, checks, options.longest_check_s);
    for (std::size_t i = 0; i < to_run.size(); ++i) results[to_run[i]].finding = findings[i];
    out.insert(out.end(), results.begin(), results.end());
  }
  return out;
}

}  // namespace wholehand
