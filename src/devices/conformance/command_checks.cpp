// Checks of commands to an enabled device that nobody holds. Efforts stay below kEffortShare of the
// limit, except in commands.beyond_limit.
#include "devices/conformance/conformance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace wholehand {
namespace {

constexpr double kPulse_s = 0.02;
constexpr double kSoon_s = 0.1;
constexpr double kBeyond = 1.5, kBeyond_s = 0.005;  // share of the limit, and duration
constexpr double kClipped = 1.05;

CheckFinding accepted(int result, const char* what) {
  return result >= 0 ? passed() : failed(std::string(what) + " returns " + std::to_string(result));
}

CheckFinding neutral(DriverBench& bench) {
  return accepted(bench.writeNeutral(), "a command of zeros");
}

CheckFinding often(DriverBench& bench) {
  for (int i = 0; i < 50; ++i) {
    if (bench.writeNeutral() < 0) return failed("command " + std::to_string(i) + " fails");
  }
  return passed();
}

CheckFinding sequenceSkips(DriverBench& bench) {
  (void)bench.writeNeutral();
  bench.startSequenceAt(bench.sequence() + 1000);
  return accepted(bench.writeNeutral(), "a sequence that skips 1,000");
}

CheckFinding sequenceRestarts(DriverBench& bench) {
  for (int i = 0; i < 5; ++i) (void)bench.writeNeutral();
  if (bench.control(WH_DISABLE) < 0 || bench.control(WH_ENABLE) < 0) {
    return skipped("is not enabled again");
  }
  bench.startSequenceAt(0);
  CheckFinding first =
      accepted(bench.writeNeutral(), "the first command after WH_ENABLE, sequence 1,");
  if (first.outcome != Outcome::kPassed) return first;
  // A composite reports a part that refused it in the next sample.
  bool enabled = false;
  everyMillisecond(kSoon_s, [&] {
    (void)bench.writeNeutral();
    enabled = (bench.read().sample.status & WH_ENABLED) != 0;
    return !enabled;
  });
  return enabled ? passed() : failed("is not enabled after the first command, sequence 1");
}

CheckFinding longerCommand(DriverBench& bench) {
  struct {
    wh_command command;
    double later[4];
  } longer{};
  longer.command.size = sizeof(longer);
  longer.command.axes = static_cast<std::uint32_t>(bench.axes().size());
  longer.command.sequence = bench.sequence() + 1;
  bench.startSequenceAt(longer.command.sequence);
  return accepted(bench.plugin().write(bench.device(), &longer.command), "a longer command");
}

// Sends a command that must be refused; `effort` is its effort on one axis. Returns what is wrong.
std::string refused(DriverBench& bench, std::size_t axis, double effort, std::uint32_t axes,
                    const std::string& what) {
  (void)bench.writeNeutral();
  std::array<double, WH_MAX_AXES> efforts{};
  efforts.at(axis) = effort;
  const int result = bench.write(efforts, axes);
  const SampleRead now = bench.read();
  (void)bench.writeNeutral();
  if (now.result < 0) return "no sample comes after " + what;
  if (!std::isfinite(now.sample.position[axis])) return what + " reaches the position";
  if (result < 0) return {};
  const double given = now.sample.effort[axis];
  return std::isfinite(given) && given == 0.0 ? std::string() : what + " is taken";
}

CheckFinding fewerAxes(DriverBench& bench) {
  const auto axes = static_cast<std::uint32_t>(bench.axes().size());
  if (axes < 2) return skipped("has one axis");
  return unless(refused(bench, 0, 0.5 * kEffortShare * bench.axes()[0].effort_limit, axes - 1,
                        "a command of one axis too few"));
}

CheckFinding moreAxes(DriverBench& bench) {
  const auto axes = static_cast<std::uint32_t>(bench.axes().size());
  return unless(refused(bench, 0, 0.5 * kEffortShare * bench.axes()[0].effort_limit, axes + 1,
                        "a command of one axis too many"));
}

// Fails with the first axis that takes efforts and for which `wrong` returns a text.
template <class Violation>
CheckFinding eachEffort(DriverBench& bench, Violation violation) {
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    if (bench.axes()[a].effort_meaning != WH_EFFORT) continue;
    const std::string text = violation(a);
    if (!text.empty()) return failed(std::string(bench.axes()[a].name) + ": " + text);
  }
  return passed();
}

CheckFinding notANumber(DriverBench& bench) {
  return eachEffort(bench, [&](std::size_t a) {
    return refused(bench, a, std::numeric_limits<double>::quiet_NaN(), 0, "NaN");
  });
}

CheckFinding infinite(DriverBench& bench) {
  return eachEffort(bench, [&](std::size_t a) {
    return refused(bench, a, std::numeric_limits<double>::infinity(), 0, "infinity");
  });
}

CheckFinding stillThereAfterBad(DriverBench& bench) {
  std::array<double, WH_MAX_AXES> efforts{};
  efforts.at(bench.axes().size() - 1) = std::numeric_limits<double>::quiet_NaN();
  (void)bench.write(efforts);
  const int result = bench.writeNeutral();
  const SampleRead now = bench.read();
  if (now.result < 0) return failed("no sample comes any more");
  const bool disabled = (now.sample.status & WH_ENABLED) == 0;
  if (result >= 0 || disabled) return passed(disabled ? "has disabled itself" : "goes on");
  return failed("refuses commands, and says that it is enabled");
}

CheckFinding pulses(DriverBench& bench) {
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    if (bench.axes()[a].effort_meaning != WH_EFFORT) continue;
    for (const double share : {0.5 * kEffortShare, -0.5 * kEffortShare}) {
      int worst = WH_OK;
      everyMillisecond(kPulse_s, [&] { return (worst = bench.writeShare(a, share)) >= 0; });
      (void)bench.writeNeutral();
      if (worst < 0)
        return failed(std::string(bench.axes()[a].name) + ": a tenth of its limit is refused");
    }
  }
  return passed("±" + number(50.0 * kEffortShare) + " % of each limit");
}

// Measured effort of an axis while one is commanded, as soon as it is not zero.
double answerTo(DriverBench& bench, std::size_t axis, double share) {
  double measured = 0.0;
  everyMillisecond(kSoon_s, [&] {
    if (bench.writeShare(axis, share) < 0) return false;
    measured = bench.read().sample.effort[axis];
    return measured == 0.0;
  });
  (void)bench.writeNeutral();
  return measured;
}

CheckFinding measuredSign(DriverBench& bench) {
  bool known = false;
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    if (bench.axes()[a].effort_meaning != WH_EFFORT) continue;
    const double measured = answerTo(bench, a, kEffortShare);
    if (std::isnan(measured)) continue;
    known = true;
    if (!(measured > 0.0)) {
      return failed(std::string(bench.axes()[a].name) + " measures " + number(measured) + " for " +
                    number(kEffortShare * bench.axes()[a].effort_limit));
    }
  }
  return known ? passed() : skipped("efforts are not measured");
}

// Checks the measured effort of each axis after it was pushed. Passes when all measured efforts are
// right.
template <class Violation>
CheckFinding eachMeasured(DriverBench& bench, Violation violation) {
  bool known = false;
  CheckFinding out = eachEffort(bench, [&](std::size_t a) -> std::string {
    const double measured = answerTo(bench, a, kEffortShare);
    if (std::isnan(measured)) return {};
    known = true;
    return violation(a, measured);
  });
  return known || out.outcome == Outcome::kFailed ? out : skipped("efforts are not measured");
}

// Largest measured effort that is accepted when none is commanded.
double mostLeft(const DriverBench& bench, std::size_t a) {
  return std::abs(bench.neutral(a)) + 0.02 * bench.axes()[a].effort_limit;
}

CheckFinding neutralReturns(DriverBench& bench) {
  return eachMeasured(bench, [&](std::size_t a, double measured) {
    double left = measured;
    const double most = std::abs(bench.neutral(a)) + 0.1 * std::abs(measured);
    everyMillisecond(kSoon_s, [&] {
      (void)bench.writeNeutral();
      left = bench.read().sample.effort[a];
      return std::abs(left) > most;
    });
    return std::abs(left) <= most ? std::string()
                                  : "measures " + number(left) + " after a command of zeros";
  });
}

CheckFinding disabledIsNeutral(DriverBench& bench) {
  return eachMeasured(bench, [&](std::size_t a, double) -> std::string {
    (void)bench.writeShare(a, kEffortShare);
    if (bench.control(WH_DISABLE) < 0) return "WH_DISABLE fails";
    const double left = bench.read().sample.effort[a];
    if (bench.control(WH_ENABLE) < 0) return "is not enabled again";
    return std::abs(left) <= mostLeft(bench, a) ? std::string()
                                                : "measures " + number(left) + " then";
  });
}

CheckFinding enabledIsNeutral(DriverBench& bench) {
  return eachMeasured(bench, [&](std::size_t a, double) -> std::string {
    (void)bench.writeShare(a, kEffortShare);
    if (bench.control(WH_DISABLE) < 0 || bench.control(WH_ENABLE) < 0) {
      return "is not enabled again";
    }
    const double left = bench.read().sample.effort[a];
    return std::abs(left) <= mostLeft(bench, a) ? std::string() : "begins with " + number(left);
  });
}

// Commands more than the limit to one axis. Returns what is wrong.
std::string beyond(DriverBench& bench, std::size_t a, double share) {
  bool reported = false;
  double most = 0.0;
  everyMillisecond(kBeyond_s, [&] {
    if (bench.writeShare(a, share) < 0) return false;
    const SampleRead now = bench.read();
    reported = reported || (now.sample.status & WH_SATURATED) != 0;
    const double given = std::abs(now.sample.effort[a]);
    if (std::isfinite(given)) most = std::max(most, given);
    return true;
  });
  const bool refuses = bench.writeShare(a, share) < 0;
  (void)bench.writeNeutral();
  if (refuses) return {};
  if (most > kClipped * bench.axes()[a].effort_limit) return "gives " + number(most);
  return reported ? std::string() : "no sample says WH_SATURATED";
}

CheckFinding beyondLimit(DriverBench& bench) {
  return eachEffort(bench, [&](std::size_t a) {
    std::string forth = beyond(bench, a, kBeyond);
    return forth.empty() ? beyond(bench, a, -kBeyond) : forth;
  });
}

constexpr const char* kFinite = "return WH_FAILED from write for what is not finite";
constexpr const char* kCount = "return WH_FAILED from write for another number of axes";
using enum DriverStage;

}  // namespace

std::span<const Check> commandChecks() {
  static constexpr Check kChecks[] = {
      {"commands.neutral", "a command of zeros is taken", "is it enabled?", neutral, kEnabled},
      {"commands.often", "50 commands at once are taken", "hand over the newest command only",
       often, kEnabled},
      {"commands.sequence_skips", "a sequence that skips is taken",
       "a host writes the newest command: require only that it is another", sequenceSkips,
       kEnabled},
      {"commands.sequence_restarts", "after WH_ENABLE the sequence may begin at 1 again",
       "forget the last sequence at WH_ENABLE", sequenceRestarts, kEnabled},
      {"commands.longer", "a longer command of a newer program is taken",
       "accept every size that is not smaller than yours", longerCommand, kEnabled},
      {"commands.fewer_axes", "a command of too few axes is not carried out", kCount, fewerAxes,
       kEnabled},
      {"commands.more_axes", "a command of too many axes is not carried out", kCount, moreAxes,
       kEnabled},
      {"commands.nan", "NaN is not carried out", kFinite, notANumber, kEnabled},
      {"commands.infinity", "infinity is not carried out", kFinite, infinite, kEnabled},
      {"commands.after_bad", "after a bad command it goes on, or says that it is disabled",
       "refuse the command, not the ones after it", stillThereAfterBad, kEnabled},
      {"commands.pulses", "a tenth of the limit is taken on every axis, both ways",
       "return WH_FAILED only where the drive is in fault", pulses, kEnabled},
      {"commands.sign", "the effort measured has the sign of the one asked for",
       "give the motor its sign in read and write alike", measuredSign, kEnabled},
      {"commands.neutral_again", "the effort measured goes back with the command",
       "hold an effort until the next command, not longer", neutralReturns, kEnabled},
      {"commands.disabled_neutral", "WH_DISABLE takes the effort away",
       "send neutral before disabling", disabledIsNeutral, kEnabled},
      {"commands.enabled_neutral", "WH_ENABLE begins at neutral", "forget the last command",
       enabledIsNeutral, kEnabled},
      {"commands.beyond_limit", "1.5 times the limit is refused, or clipped with WH_SATURATED",
       "clip to effort_limit and say so", beyondLimit, kEnabled, Effect::kOverreaches},
  };
  return kChecks;
}

}  // namespace wholehand
