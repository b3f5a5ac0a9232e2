// Checks of the drive's watchdog.
#include "devices/conformance/conformance.hpp"
#include "devices/conformance/pushes.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kBeforeFirst_s = 1.0;
constexpr double kLatest = 1.5, kLatestMore_s = 0.02;  // factor on silence_s, and reserve for the
                                                       // clock and one sample
constexpr double kGiveUp_s = 10.0;
constexpr double kFed_s = 0.2;

// Longest watchdog timeout of all axes; no effort may remain after it.
double silence_s(const DriverBench& bench) {
  double longest = 0.0;
  for (const wh_axis& axis : bench.axes()) {
    if (axis.effort_meaning == WH_EFFORT) longest = std::max(longest, axis.silence_s);
  }
  return longest;
}

bool letGo(const SampleRead& s) {
  return s.result >= 0 &&
         ((s.sample.status & WH_SILENCED) != 0 || (s.sample.status & WH_ENABLED) == 0);
}

// Time after the last command at which every axis must have been released [s].
double latest_s(const DriverBench& bench) {
  return kLatest * silence_s(bench) + kLatestMore_s;
}

// Reason why the drive did not release in time after the commands end now; empty: it did. Only a
// sample that was requested too late and shows no release counts as a failure, so that a stall of
// this machine has no effect.
std::string lateSilence(DriverBench& bench, bool writing) {
  const std::int64_t last_ns = monotonicNow_ns();
  bench.fallSilent();
  bool late = false;
  everyMillisecond(kGiveUp_s, [&] {
    if (writing) (void)bench.writeNeutral();
    late = static_cast<double>(monotonicNow_ns() - last_ns) * 1e-9 > latest_s(bench);
    const bool silent = letGo(bench.read());
    late = late && !silent;
    return !silent && !late;
  });
  if (!late) return {};
  return "no sample says WH_SILENCED " + number(latest_s(bench) * 1e3) +
         " ms after the last command, " + number(silence_s(bench) * 1e3) + " ms are stated";
}

std::string noWatchdog(const DriverBench& bench) {
  return silence_s(bench) > 0.0 ? std::string() : "states no watchdog";
}

CheckFinding beforeFirst(DriverBench& bench) {
  CheckFinding out = passed();
  everyMillisecond(kBeforeFirst_s, [&] {
    if (letGo(bench.read())) out = failed("lets go before the first command");
    return out.outcome == Outcome::kPassed;
  });
  return out;
}

CheckFinding fed(DriverBench& bench) {
  std::int64_t before_ns = monotonicNow_ns(), longest_ns = 0;
  bool silent = false;
  everyMillisecond(kFed_s, [&] {
    (void)bench.writeNeutral();
    const std::int64_t now_ns = monotonicNow_ns();
    longest_ns = std::max(longest_ns, now_ns - before_ns);
    before_ns = now_ns;
    silent = silent || letGo(bench.read());
    return !silent;
  });
  if (!silent) return passed();
  if (static_cast<double>(longest_ns) * 1e-9 > 0.5 * silence_s(bench)) {
    return skipped("this machine stood still for too long");
  }
  return failed("lets go although a command comes every millisecond");
}

CheckFinding silenced(DriverBench& bench) {
  if (std::string none = noWatchdog(bench); !none.empty()) return failed(none);
  for (int i = 0; i < 3; ++i) (void)bench.writeNeutral();
  return unless(lateSilence(bench, false));
}

CheckFinding gone(DriverBench& bench) {
  Shares shares{};
  std::fill_n(shares.begin(), bench.axes().size(), kEffortShare);
  (void)bench.writeShares(shares);
  if (std::string late = lateSilence(bench, false); !late.empty())
    return skipped("does not let go");
  // The first axis to be released is reported; the others may have longer watchdogs.
  const wh_sample now =
      bench.idle(static_cast<int>(std::ceil(latest_s(bench) * 1e3)), false).back().sample;
  bool known = false;
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    if (bench.axes()[a].effort_meaning != WH_EFFORT || std::isnan(now.effort[a])) continue;
    known = true;
    if (std::abs(now.effort[a]) <= 0.02 * bench.axes()[a].effort_limit) continue;
    return failed(std::string(bench.axes()[a].name) + " still measures " + number(now.effort[a]));
  }
  return known ? passed() : skipped("efforts are not measured");
}

CheckFinding latched(DriverBench& bench) {
  (void)bench.writeNeutral();
  if (std::string late = lateSilence(bench, false); !late.empty())
    return skipped("does not let go");
  const std::vector<SampleRead> after = bench.idle(30, true);
  return std::all_of(after.begin(), after.end(), letGo)
             ? passed()
             : failed("comes back with the next command");
}

CheckFinding enabledAnew(DriverBench& bench) {
  (void)bench.writeNeutral();
  if (std::string late = lateSilence(bench, false); !late.empty())
    return skipped("does not let go");
  if (bench.control(WH_DISABLE) < 0 || bench.control(WH_ENABLE) < 0) {
    return failed("cannot be enabled again");
  }
  const std::vector<SampleRead> after = bench.idle(30, true);
  return letGo(after.back()) ? failed("stays silenced after WH_ENABLE") : passed();
}

CheckFinding dropped(DriverBench& bench) {
  (void)bench.writeNeutral();
  const int result = bench.control(WH_DROP_WATCHDOG);
  if (result == WH_UNSUPPORTED) return passed("WH_DROP_WATCHDOG is not supported");
  if (result < 0) return failed("WH_DROP_WATCHDOG returns " + std::to_string(result));
  return unless(lateSilence(bench, true));
}

constexpr const char* kLatch = "stay silenced until WH_ENABLE: the person must arm again";
using enum DriverStage;

}  // namespace

std::span<const Check> watchdogChecks() {
  static constexpr Check kChecks[] = {
      {"watchdog.before_first", "it does not let go for 1 s before the first command",
       "begin with the first command, or feed the drive until then", beforeFirst, kEnabled},
      {"watchdog.fed", "it does not let go while commands come",
       "feed the drive with every command", fed, kEnabled},
      {"watchdog.silenced", "without commands it lets go within silence_s, and says WH_SILENCED",
       "switch the drive's watchdog on, and report it", silenced, kEnabled},
      {"watchdog.neutral", "then it gives no effort", "let the drive go to neutral by itself", gone,
       kEnabled},
      {"watchdog.latched", "then commands do not bring it back", kLatch, latched, kEnabled},
      {"watchdog.enable", "then WH_DISABLE and WH_ENABLE do", "clear it at WH_ENABLE", enabledAnew,
       kEnabled},
      {"watchdog.dropped", "after WH_DROP_WATCHDOG it lets go although commands come",
       "stop feeding the drive, or return WH_UNSUPPORTED", dropped, kEnabled},
  };
  return kChecks;
}

}  // namespace wholehand
