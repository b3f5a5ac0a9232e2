// Checks of the cost of read and write, by CPU time and counts, independent of the machine's load.
#include "devices/conformance/conformance.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/system_call_counter.hpp"

#include <algorithm>
#include <fstream>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace wholehand {
namespace {

constexpr int kCalls = 500, kFewCalls = 21;
constexpr double kMostCpu_us = 100.0;  // a tenth of a period at 1 kHz
constexpr double kLongestCall_ms = 20.0;
constexpr int kAttempts = 3;

using Call = int (*)(DriverBench&);

int readOnce(DriverBench& bench) {
  return bench.read().result;
}
int writeOnce(DriverBench& bench) {
  return bench.writeNeutral();
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

CheckFinding cpuTime(DriverBench& bench, Call call) {
  std::vector<double> times_us;
  for (int i = 0; i < kCalls; ++i) {
    const std::int64_t before_ns = threadCpuNow_ns();
    (void)call(bench);
    times_us.push_back(static_cast<double>(threadCpuNow_ns() - before_ns) * 1e-3);
  }
  const double typical_us = median(times_us);
  const std::string text = number(typical_us) + " µs of CPU (median)";
  return typical_us <= kMostCpu_us ? passed(text) : failed("takes " + text);
}

// A driver for hosts may block, but only for so long that its samples are not stale.
CheckFinding wallTime(DriverBench& bench, Call call) {
  std::vector<double> times_ms;
  for (int i = 0; i < kFewCalls; ++i) {
    const std::int64_t before_ns = monotonicNow_ns();
    (void)call(bench);
    times_ms.push_back(static_cast<double>(monotonicNow_ns() - before_ns) * 1e-6);
  }
  const double typical_ms = median(times_ms);
  if (typical_ms <= kLongestCall_ms) return passed();
  return failed("takes " + number(typical_ms) + " ms (median)");
}

long waitsOfThread() {
  rusage use{};
  (void)::getrusage(RUSAGE_THREAD, &use);
  return use.ru_nvcsw;
}

// Counts voluntary context switches: a blocking thread makes one, a preempted thread does not.
CheckFinding waits(DriverBench& bench, Call call) {
  if (!bench.neverWaits()) return skipped("does not say WH_NEVER_WAITS");
  long least = kCalls;
  for (int attempt = 0; attempt < kAttempts && least > 0;
       ++attempt) {  // the first attempt may fault a page in
    const long before = waitsOfThread();
    for (int i = 0; i < kCalls / 5; ++i) (void)call(bench);
    least = std::min(least, waitsOfThread() - before);
  }
  return least <= 0 ? passed()
                    : failed("waits " + std::to_string(least) + " times in " +
                             std::to_string(kCalls / 5) + " calls");
}

CheckFinding allocations(DriverBench& bench, Call call) {
  if (!allocationCountingAvailable()) return skipped("malloc is not counted in this build");
  (void)call(bench);
  const AllocationScope scope;
  for (int i = 0; i < kCalls; ++i) (void)call(bench);
  const std::uint64_t count = scope.allocations() + scope.releases();
  if (count == 0) return passed();
  return failed("allocates or frees " + std::to_string(count) + " times in " +
                std::to_string(kCalls) + " calls");
}

// Counts system calls that may block indefinitely.
CheckFinding systemCalls(DriverBench& bench, Call call) {
  if (!bench.neverWaits()) return skipped("does not say WH_NEVER_WAITS");
  if (const std::string why = watchSystemCalls(); !why.empty()) return skipped(why);
  struct Blocking {
    int number;
    const char* name;
  };
  static constexpr Blocking kBlocking[] = {
      {SYS_nanosleep, "nanosleep"}, {SYS_clock_nanosleep, "clock_nanosleep"},
      {SYS_openat, "openat"},       {SYS_fsync, "fsync"},
      {SYS_fdatasync, "fdatasync"}, {SYS_mmap, "mmap"},
      {SYS_munmap, "munmap"},       {SYS_sched_yield, "sched_yield"}};
  (void)call(bench);
  std::array<std::uint64_t, std::size(kBlocking)> before{};
  for (std::size_t i = 0; i < before.size(); ++i)
    before[i] = threadSystemCalls(kBlocking[i].number);
  countSystemCalls(true);
  for (int i = 0; i < kFewCalls; ++i) (void)call(bench);
  countSystemCalls(false);
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (threadSystemCalls(kBlocking[i].number) > before[i]) {
      return failed(std::string("calls ") + kBlocking[i].name);
    }
  }
  return passed();
}

// Child processes of this process's main thread.
std::string children() {
  std::string all;
  std::ifstream file("/proc/self/task/" + std::to_string(::getpid()) + "/children");
  std::getline(file, all);
  return all;
}

CheckFinding processes(DriverBench& bench, Call call) {
  const std::string before = children();
  for (int i = 0; i < kFewCalls; ++i) (void)call(bench);
  return children() == before ? passed() : failed("starts a process");
}

CheckFinding hostLinesDuring(DriverBench& bench, Call call) {
  const std::size_t before = bench.hostLines().size();
  for (int i = 0; i < kFewCalls; ++i) (void)call(bench);
  return bench.hostLines().size() == before ? passed()
                                            : failed("says \"" + bench.hostLines().back() + "\"");
}

template <CheckFinding (*Measure)(DriverBench&, Call), Call Which>
CheckFinding of(DriverBench& bench) {
  return Measure(bench, Which);
}

constexpr const char* kThread =
    "talk to the bus in a thread of your own, hand over the newest value";
constexpr const char* kBuffers = "allocate in open what read and write need";
constexpr const char* kSay = "say is not for read and write: set vendor_code";
using enum DriverStage;

}  // namespace

std::span<const Check> timeChecks() {
  static constexpr Check kChecks[] = {
      {"time.read_wall", "read returns within 20 ms", kThread, of<wallTime, readOnce>},
      {"time.read_cpu", "read takes at most 100 µs of CPU time", kThread, of<cpuTime, readOnce>},
      {"time.read_waits", "with WH_NEVER_WAITS read does not wait", kThread, of<waits, readOnce>},
      {"time.read_calls", "with WH_NEVER_WAITS read makes no system call that sleeps or opens",
       kThread, of<systemCalls, readOnce>},
      {"time.read_allocations", "read allocates nothing", kBuffers, of<allocations, readOnce>},
      {"time.read_processes", "read starts no process", kThread, of<processes, readOnce>},
      {"time.read_says", "read does not call say", kSay, of<hostLinesDuring, readOnce>},
      {"time.write_wall", "write returns within 20 ms", kThread, of<wallTime, writeOnce>, kEnabled},
      {"time.write_cpu", "write takes at most 100 µs of CPU time", kThread, of<cpuTime, writeOnce>,
       kEnabled},
      {"time.write_waits", "with WH_NEVER_WAITS write does not wait", kThread, of<waits, writeOnce>,
       kEnabled},
      {"time.write_calls", "with WH_NEVER_WAITS write makes no system call that sleeps or opens",
       kThread, of<systemCalls, writeOnce>, kEnabled},
      {"time.write_allocations", "write allocates nothing", kBuffers, of<allocations, writeOnce>,
       kEnabled},
      {"time.write_processes", "write starts no process", kThread, of<processes, writeOnce>,
       kEnabled},
      {"time.write_says", "write does not call say", kSay, of<hostLinesDuring, writeOnce>,
       kEnabled},
  };
  return kChecks;
}

}  // namespace wholehand
