#include "realtime_guarantees/tick_watch.hpp"

#include "loop/realtime/allocation_counter.hpp"
#include "loop/realtime/system_call_counter.hpp"
#include "support/lock_counter.hpp"

#include <algorithm>
#include <cstdio>
#include <sys/syscall.h>

namespace wholehand::test {

const char* kindName(Kind kind) {
  constexpr std::array<const char*, kKinds> kNames{"allocations",
                                                   "releases",
                                                   "locks taken or tried",
                                                   "waits for another",
                                                   "wakes of another",
                                                   "system calls but those below",
                                                   "CPU clock read",
                                                   "clock_nanosleep",
                                                   "page faults, minor",
                                                   "page faults, major",
                                                   "context switches, voluntary",
                                                   "context switches, involuntary"};
  return kNames.at(static_cast<std::size_t>(kind));
}

bool counting() {
  return allocationCountingAvailable() && lockCountingAvailable();
}

bool granted(const SetupReport& setup, const std::string& what) {
  return std::any_of(setup.begin(), setup.end(),
                     [&](const SetupLine& l) { return l.what == what && l.granted; });
}

Counts countsOfThisThread() noexcept {
  const LockCalls locks = threadLockCalls();
  const ThreadUsage usage = threadUsage();
  const auto clocks = static_cast<std::int64_t>(threadSystemCalls(SYS_clock_gettime));
  const auto sleeps = static_cast<std::int64_t>(threadSystemCalls(SYS_clock_nanosleep));
  return {static_cast<std::int64_t>(threadAllocations()),
          static_cast<std::int64_t>(threadReleases()),
          static_cast<std::int64_t>(locks.locks),
          static_cast<std::int64_t>(locks.waits),
          static_cast<std::int64_t>(locks.wakes),
          static_cast<std::int64_t>(threadSystemCalls()) - clocks - sleeps,
          clocks,
          sleeps,
          usage.minor_faults,
          usage.major_faults,
          usage.voluntary_switches,
          usage.involuntary_switches};
}

void TickWatch::count(Counts& into, std::int64_t tick) noexcept {
  const Counts now = countsOfThisThread();
  for (std::size_t k = 0; k < kKinds; ++k) {
    into[k] += now[k] - before_[k];
    if (tick >= 0 && now[k] > before_[k]) last_tick_with_[k] = tick;
  }
  before_ = now;
}

void TickWatch::beforeTick(const TickRecord& record) noexcept {
  countSystemCalls(false);
  if (!begun_) {
    no_system_calls_ = watchSystemCalls();
    last_tick_with_.fill(-1);
  } else if (watches(record) && record.tick >= plan_.warm_ticks) {
    count(between_, -1);
  }
  begun_ = true;
  before_ = countsOfThisThread();
  countSystemCalls(watches(record));
  inner_.beforeTick(record);
}

void TickWatch::afterTick(const TickRecord& record) noexcept {
  inner_.afterTick(record);
  countSystemCalls(false);
  if (!watches(record)) return;
  const bool warm = record.tick >= plan_.warm_ticks;
  count(warm ? in_tick_ : in_warm_ticks_, static_cast<std::int64_t>(record.tick));
  ++(warm ? ticks_ : warm_);
  if (lastTickWith(Kind::kSystemCall) == static_cast<std::int64_t>(record.tick)) noteCall();
  countSystemCalls(record.tick < plan_.last_tick);
}

void TickWatch::noteCall() noexcept {
  for (int number = 0; number < 512; ++number) {
    const bool known = number == SYS_clock_gettime || number == SYS_clock_nanosleep;
    if (!known && threadSystemCalls(number) > 0) system_call_ = number;
  }
}

void TickWatch::print(const std::string& title) const {
  std::printf("%s\n  %-30s %14s %14s %14s\n", title.c_str(), "", "in tick()", "between ticks",
              "warming up");
  std::printf("  %-30s %14llu %14llu %14llu\n", "ticks", static_cast<unsigned long long>(ticks_),
              static_cast<unsigned long long>(ticks_), static_cast<unsigned long long>(warm_));
  for (std::size_t k = 0; k < kKinds; ++k) {
    const auto kind = static_cast<Kind>(k);
    std::printf("  %-30s %14lld %14lld %14lld", kindName(kind), static_cast<long long>(in_tick_[k]),
                static_cast<long long>(between_[k]), static_cast<long long>(in_warm_ticks_[k]));
    const bool known = kind == Kind::kClock || kind == Kind::kSleep;
    if (!known && last_tick_with_[k] >= 0) {
      std::printf("   last in tick %lld", static_cast<long long>(last_tick_with_[k]));
    }
    if (kind == Kind::kSystemCall && system_call_ >= 0) {
      std::printf(", one of them number %d", system_call_);
    }
    std::printf("\n");
  }
  if (!no_system_calls_.empty()) {
    std::printf("  system calls are not counted: %s\n", no_system_calls_.c_str());
  }
}

}  // namespace wholehand::test
