#include "devices/conformance/conformance.hpp"
#include "devices/conformance/pushes.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

// Checks by motion: each axis is pushed by up to kEffortShare of its limit while nobody holds it,
// and the resulting positions are compared with the commands. Status bits and measured efforts are
// not used, except in motion.measured.
namespace wholehand {
namespace {

// Shared by the checks: texts for people, and the choice of axes.

/// Number of measurements that must agree before a check fails.
constexpr int kMotionAttempts = 2;

std::string nameOf(const DriverBench& bench, std::size_t a) {
  return bench.axes()[a].name;
}

const char* unit(const wh_axis& axis) {
  return axis.kind == WH_ROTATION ? " N·m" : " N";
}

std::string effort(const DriverBench& bench, std::size_t a, double share) {
  const wh_axis& axis = bench.axes()[a];
  return number(share * axis.effort_limit) + unit(axis);
}

std::string ms(double seconds) {
  return number(std::round(seconds * 1e4) * 0.1) + " ms";
}

std::string percent(double share) {
  return number(std::round(100.0 * share)) + " %";
}

/// Reason why some or all axes are not checked; empty: all are checked.
std::string whyNotAll(const DriverBench& bench, const std::vector<PushedAxis>& axes) {
  std::string late, still;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!axes[a].asked || (axes[a].moved && !axes[a].late)) continue;
    std::string& names = axes[a].late ? late : still;
    names += (names.empty() ? "" : ", ") + nameOf(bench, a);
  }
  if (!late.empty()) return late + ": this machine stood still meanwhile";
  return still.empty() ? still : still + ": does not move (motion.moves)";
}

/// Checks every axis that takes efforts and moved. A failure must be confirmed by a second
/// measurement. The finding names all axes that fail.
template <class Violation>
CheckFinding eachMoved(DriverBench& bench, Violation violation) {
  CheckFinding out;
  for (int attempt = 0; attempt < kMotionAttempts; ++attempt) {
    std::string failures;
    const std::vector<PushedAxis>& axes = bench.pushed();
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!axes[a].asked || !axes[a].moved || axes[a].late) continue;
      const std::string text = violation(axes[a], a);
      if (!text.empty()) failures += (failures.empty() ? "" : "; ") + nameOf(bench, a) + " " + text;
    }
    bench.forgetStalls();
    if (failures.empty()) {
      const std::string why = whyNotAll(bench, axes);
      if (why.empty()) return passed();
      return attempt > 0 ? out : skipped(why);  // the failure may prevent another push
    }
    out = failed(failures);
    if (attempt + 1 == kMotionAttempts || !bench.reach(DriverStage::kEnabled).empty()) break;
    bench.pushAnew();
  }
  return out;
}

// How a push ends, and what moves at neutral, judged by the motion of every axis.

constexpr double kLeft = 0.25;  // share of the push that may be left
constexpr double kOwn = 0.05;   // share of the limit that may act at neutral
constexpr double kOver_s = 0.005, kOverShare = 1.5, kClipped = 1.2;
constexpr double kSoon_s = 0.01;  // allowed beyond the stated delay
constexpr double kSilences = 1.5, kSilenceMore_s = 0.02;
constexpr double kLongestReopen_s = 0.3;

// Fails for the axes on which the push still acts after it should have ended. `when` is part of the
// text.
CheckFinding over(DriverBench& bench, double allow_s, bool writes, const std::string& when,
                  const std::function<std::string(PushSequence&)>& stop) {
  const std::vector<PushedAxis>& axes = bench.pushed();
  const LeftOver left = leftAfter(bench, axes, allow_s, writes, stop);
  bench.forgetStalls();
  if (!left.not_judged.empty()) return skipped(left.not_judged);
  std::string failures;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!axes[a].moved || axes[a].late || !(left.share[a] > kLeft)) continue;
    failures += (failures.empty() ? "" : "; ") + nameOf(bench, a) + " was pushed with " +
                effort(bench, a, left.pushed[a]) + ", and " + when + " it moves on as with " +
                effort(bench, a, left.share[a] * left.pushed[a]);
  }
  if (!failures.empty()) return failed(failures);
  const std::string why = whyNotAll(bench, axes);
  return why.empty() ? passed() : skipped(why);
}

double longestDelay_s(const DriverBench& bench) {
  double longest = 0.0;
  for (const wh_axis& axis : bench.axes()) longest = std::max(longest, axis.delay_s);
  return longest;
}

double longestSilence_s(const DriverBench& bench) {
  double longest = 0.0;
  for (const wh_axis& axis : bench.axes()) longest = std::max(longest, axis.silence_s);
  return longest;
}

constexpr double kNeutral_s = 0.1;
constexpr double kEnd = 0.01, kGone = 0.02;  // shares of the travel

// Axes that have left their resting position.
std::string gone(const DriverBench& bench, const PushSequence& sequence,
                 const std::vector<double>& from) {
  std::string out;
  for (std::size_t a = 0; a < from.size(); ++a) {
    const wh_axis& axis = bench.axes()[a];
    const double moved = sequence.position(a) - from[a];
    const double most = kGone * (axis.upper - axis.lower) + 3.0 * axis.resolution;
    if (axis.effort_meaning != WH_EFFORT || std::abs(moved) <= most) continue;
    out += (out.empty() ? "" : "; ") + nameOf(bench, a) +
           " was given nothing but neutral, and is " + number(moved) +
           (axis.kind == WH_ROTATION ? " rad" : " m") + " away after " + ms(kNeutral_s);
  }
  return out;
}

// Axes at an end of their travel, where an effort towards the end would not show.
std::string onEnd(const DriverBench& bench, const PushSequence& sequence) {
  std::string out;
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    const wh_axis& axis = bench.axes()[a];
    const double room =
        std::min(axis.upper - sequence.position(a), sequence.position(a) - axis.lower);
    if (axis.effort_meaning != WH_EFFORT || room > kEnd * (axis.upper - axis.lower)) continue;
    out += (out.empty() ? "" : ", ") + nameOf(bench, a);
  }
  return out.empty() ? out : out + ": on the end of its travel";
}

// Checks that nothing moves when the device is enabled at neutral from rest. Skips, with the
// reason, when this cannot be checked.
CheckFinding neutralFromRest(DriverBench& bench) {
  bench.disableAtNeutral();
  if (awaitRest(bench) >= 0) return skipped("does not rest (motion.rests)");
  PushSequence before(bench);
  before.watch(0.002);
  std::vector<double> from;
  for (std::size_t a = 0; a < bench.axes().size(); ++a) from.push_back(before.position(a));
  if (std::string why = bench.reach(DriverStage::kEnabled); !why.empty()) return skipped(why);
  PushSequence sequence(bench);
  sequence.push({}, kNeutral_s);
  bench.forgetStalls();
  if (std::string why = gone(bench, sequence, from); !why.empty()) return failed(why);
  if (sequence.late()) return skipped("this machine stood still meanwhile");
  const std::string end = onEnd(bench, sequence);
  return end.empty() ? passed() : skipped(end);
}

// Speed caused by a pulse beyond the limit, relative to the speed that the limit would cause in
// that time.
double overLimit(DriverBench& bench, const PushedAxis& pushed, std::size_t a, double sign) {
  if (!bench.reach(DriverStage::kEnabled).empty()) return 0.0;
  bringToMiddle(bench, bench.pushed());
  PushSequence sequence(bench);
  Shares shares{};
  shares.at(a) = sign * kOverShare;
  sequence.push({}, 0.02);
  const double from_s = sequence.now_s();
  sequence.push(shares, kOver_s);
  sequence.push({}, 0.04);
  const PushTrace trace = sequence.trace(a, a);
  double given_s = 0.0, ended_s = from_s;
  for (std::size_t i = 0; i + 1 < trace.given.size(); ++i) {
    if (trace.given[i].share == 0.0) continue;
    given_s += trace.given[i + 1].at_s - trace.given[i].at_s;
    ended_s = trace.given[i + 1].at_s;
  }
  if (given_s == 0.0) return 0.0;  // the command was refused
  const double delay_s = pushed.response.delay_s;
  const Parabola before = parabolaThrough(trace, 0.0, from_s);
  const double since_s = ended_s + delay_s + 0.002, until_s = sequence.now_s();
  const Parabola after = parabolaThrough(trace, since_s, until_s);
  const double middle_s = 0.5 * (since_s + until_s) - ended_s - delay_s;
  const double lost = std::exp(std::max(0.0, pushed.response.damping) * middle_s);
  return sign * (after.speed * lost - before.speed) / (pushed.response.gain * given_s);
}

CheckFinding pushReleased(DriverBench& bench) {
  const double allow_s = kSoon_s + longestDelay_s(bench);
  return over(bench, allow_s, true, ms(allow_s) + " after the command went back to neutral",
              [](PushSequence&) { return std::string(); });
}

CheckFinding pushSilenced(DriverBench& bench) {
  if (longestSilence_s(bench) == 0.0) return skipped("states no watchdog");
  const double allow_s = kSilences * longestSilence_s(bench) + kSilenceMore_s;
  return over(bench, allow_s, false, ms(allow_s) + " after the last command", [&](PushSequence&) {
    bench.fallSilent();
    return std::string();
  });
}

CheckFinding pushDisabled(DriverBench& bench) {
  const double allow_s = kSoon_s + longestDelay_s(bench);
  return over(bench, allow_s, false, ms(allow_s) + " after WH_DISABLE", [&](PushSequence&) {
    return bench.control(WH_DISABLE) < 0 ? std::string("WH_DISABLE fails") : std::string();
  });
}

CheckFinding pushClosed(DriverBench& bench) {
  const double allow_s = kSoon_s + longestDelay_s(bench);
  return over(bench, allow_s, false, ms(allow_s) + " after closing", [&](PushSequence& sequence) {
    const double began_s = sequence.now_s();
    if (std::string why = bench.reopen(); !why.empty()) return why;
    return sequence.now_s() - began_s > kLongestReopen_s
               ? std::string("opens again so slowly that a push would have ended at a stop")
               : std::string();
  });
}

// Checks twice: at the resting position before any push, and in the middle of the travel, where the
// responses to pushes are known.
CheckFinding stillAtNeutral(DriverBench& bench) {
  CheckFinding first = neutralFromRest(bench);
  if (first.outcome == Outcome::kFailed) return first;
  const std::vector<PushedAxis>& axes = bench.pushed();
  std::string own;
  for (std::size_t a = 0; a < axes.size(); ++a) {
    const double share = axes[a].response.own;
    if (!axes[a].moved || axes[a].late || std::abs(share) <= kOwn) continue;
    own += (own.empty() ? "" : "; ") + nameOf(bench, a) +
           " is pushed to and fro, and moves as with " + effort(bench, a, share) + " beside that";
  }
  if (!own.empty()) return failed(own);
  bringToMiddle(bench, axes);
  CheckFinding second = neutralFromRest(bench);
  return second.outcome != Outcome::kFailed && first.outcome == Outcome::kPassed ? first : second;
}

CheckFinding stillEnabledAgain(DriverBench& bench) {
  const std::vector<PushedAxis>& axes = bench.pushed();
  std::string moved;
  const auto stop = [&](PushSequence& sequence) -> std::string {
    if (bench.control(WH_DISABLE) < 0) return "WH_DISABLE fails";
    if (awaitRest(bench) >= 0) return "does not rest (motion.rests)";
    sequence.watch(0.002);
    std::vector<double> before;
    for (std::size_t a = 0; a < axes.size(); ++a) before.push_back(sequence.position(a));
    if (bench.control(WH_ENABLE) < 0) return "cannot be enabled again";
    sequence.watch(0.002);
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const wh_axis& axis = bench.axes()[a];
      const double steps = std::abs(sequence.position(a) - before[a]) / axis.resolution;
      if (steps > 3.0 + 0.002 * (axis.upper - axis.lower) / axis.resolution)
        moved = nameOf(bench, a) + " jumps by " + number(steps) + " steps when it is enabled";
    }
    return {};
  };
  const LeftOver left = leftAfter(bench, axes, 0.0, false, stop);
  bench.forgetStalls();
  if (!left.not_judged.empty()) return skipped(left.not_judged);
  if (!moved.empty()) return failed(moved);
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!axes[a].moved || axes[a].late) continue;
    if (left.share[a] > kLeft) {
      return failed(nameOf(bench, a) + " begins with " +
                    effort(bench, a, left.share[a] * left.pushed[a]) + " of before");
    }
    if (std::abs(left.own[a]) > kOwn) {
      return failed(nameOf(bench, a) + " moves off as with " + effort(bench, a, left.own[a]));
    }
  }
  const std::string why = whyNotAll(bench, axes);
  return why.empty() ? passed() : skipped(why);
}

CheckFinding pushLimited(DriverBench& bench) {
  return eachMoved(bench, [&](const PushedAxis& axis, std::size_t a) -> std::string {
    for (const double sign : {1.0, -1.0}) {
      const double given = overLimit(bench, axis, a, sign);
      if (given <= kClipped) continue;
      return "was asked for " + effort(bench, a, sign * kOverShare) + " and gives about " +
             effort(bench, a, sign * given) + ", its limit is " + effort(bench, a, 1.0);
    }
    return {};
  });
}

// How a push begins and continues.

constexpr double kAlong = 0.25;         // motion of another axis, relative to its own response
constexpr double kAlike = 0.3;          // deviation of the gains of pushes of other sizes and of
                                        // the other direction
constexpr double kUnexplained = 0.11;   // share of the motion
constexpr double kDelayMore_s = 0.003;  // two periods of the loop and the uncertainty of the fit
constexpr double kMeasuredWithin = 0.25;
constexpr double kMassWithin = 1.5;  // factor, and its inverse
constexpr double kRubs = 0.25;       // share of the push: greater dry friction hides the answer
constexpr double kLightest_kg = 0.002, kHeaviest_kg = 200.0;
constexpr double kLightest_kgm2 = 1e-8, kHeaviest_kgm2 = 20.0;

CheckFinding rests(DriverBench& bench) {
  const int moving = awaitRest(bench);
  if (moving < 0) return passed();
  return failed(nameOf(bench, static_cast<std::size_t>(moving)) +
                " moves by itself for a second while it is disabled");
}

CheckFinding moves(DriverBench& bench) {
  const std::vector<PushedAxis>& axes = bench.pushed();
  std::string still;
  bench.forgetStalls();
  for (std::size_t a = 0; a < axes.size(); ++a) {
    if (!axes[a].asked || axes[a].moved || axes[a].late) continue;
    still += (still.empty() ? "" : "; ") + nameOf(bench, a) + " was given " +
             effort(bench, a, kEffortShare) + " each way for " + ms(axes[a].tried_s) +
             " and does not move";
  }
  return unless(still);
}

CheckFinding staysWithin(DriverBench& bench) {
  return eachMoved(bench, [](const PushedAxis& axis, std::size_t) {
    return axis.within ? std::string() : "is pushed, and a position leaves the travel stated";
  });
}

CheckFinding alone(DriverBench& bench) {
  const std::vector<PushedAxis>& axes = bench.pushed();
  bench.forgetStalls();
  for (std::size_t a = 0; a < axes.size(); ++a) {
    for (std::size_t j = 0; j < axes[a].along.size(); ++j) {
      if (!axes[a].asked || j == a || !(axes[a].along[j] > kAlong)) continue;
      return failed(nameOf(bench, a) + " was given effort, and " + nameOf(bench, j) +
                    (axes[a].moved
                         ? " moves along by " + percent(axes[a].along[j]) + " of its own response"
                         : " moves instead"));
    }
  }
  return passed();
}

CheckFinding sign(DriverBench& bench) {
  return eachMoved(bench, [&](const PushedAxis& axis, std::size_t a) {
    if (axis.response.gain > 0.0) return std::string();
    return "was given +" + effort(bench, a, kEffortShare) + " and moves in − direction";
  });
}

CheckFinding follows(DriverBench& bench) {
  return eachMoved(bench, [](const PushedAxis& axis, std::size_t) -> std::string {
    if (axis.response.unexplained <= kUnexplained) return {};
    return "moves in a way of which no mass, friction and delay explain " +
           percent(axis.response.unexplained) + ": its effort is not the one asked for";
  });
}

CheckFinding proportional(DriverBench& bench) {
  return eachMoved(bench, [&](const PushedAxis& axis, std::size_t a) -> std::string {
    // Dry friction cannot reverse a push, and friction as large as the push prevents all motion.
    const double rubs = axis.response.friction / kEffortShare;
    if (rubs > kRubs && rubs <= 1.0 && axis.back >= 0.0) return {};
    const auto off = [](double ratio) { return !(std::abs(ratio - 1.0) <= kAlike); };
    const auto text = [&](double ratio, double share) {
      return "answers to " + effort(bench, a, share) + " with " + percent(ratio) +
             " of what its answer to " + effort(bench, a, kEffortShare) + " lets expect";
    };
    if (off(axis.back)) return text(axis.back, -kEffortShare);
    if (off(axis.half_forth)) return text(axis.half_forth, 0.5 * kEffortShare);
    if (off(axis.half_back)) return text(axis.half_back, -0.5 * kEffortShare);
    return {};
  });
}

CheckFinding delay(DriverBench& bench) {
  return eachMoved(bench, [&](const PushedAxis& axis, std::size_t a) -> std::string {
    const double stated_s = bench.axes()[a].delay_s, found_s = axis.response.delay_s;
    if (found_s <= stated_s + kDelayMore_s) return {};
    return "answers " + ms(found_s) + " after a command, " + ms(stated_s) + " are stated";
  });
}

CheckFinding jumps(DriverBench& bench) {
  return eachMoved(bench, [&](const PushedAxis& axis, std::size_t a) -> std::string {
    if (axis.jump == 0.0) return {};
    return "stands still in its samples and then jumps by " +
           number(axis.jump / bench.axes()[a].resolution) + " steps";
  });
}

CheckFinding measured(DriverBench& bench) {
  bool any = false;
  CheckFinding out = eachMoved(bench, [&](const PushedAxis& axis, std::size_t a) -> std::string {
    for (std::size_t j = 0; j < axis.measured_elsewhere.size(); ++j) {
      if (axis.measured_elsewhere[j] > kMeasuredWithin)
        return "was given effort, and " + nameOf(bench, j) + " measures it";
    }
    if (std::isnan(axis.measured)) return {};
    any = true;
    if (std::abs(axis.measured - 1.0) <= kMeasuredWithin) return {};
    return "measures " + effort(bench, a, kEffortShare * axis.measured) + " where " +
           effort(bench, a, kEffortShare) + " were asked";
  });
  return any || out.outcome != Outcome::kPassed ? out : skipped("efforts are not measured");
}

// Effort over acceleration is the mass. It reveals a wrong unit and, with a device file, any wrong
// effort.
CheckFinding mass(DriverBench& bench) {
  bool all_known = true;
  CheckFinding out = eachMoved(bench, [&](const PushedAxis& axis, std::size_t a) -> std::string {
    const wh_axis& described = bench.axes()[a];
    const bool turns = described.kind == WH_ROTATION;
    const double found = described.effort_limit / std::abs(axis.response.gain);
    const std::string seen = "answers to " + effort(bench, a, kEffortShare) + " as " +
                             number(found) + (turns ? " kg·m²" : " kg") + " would";
    const double known = bench.mass(a);
    all_known = all_known && known > 0.0;
    if (known > 0.0 && (found > kMassWithin * known || found < known / kMassWithin)) {
      return seen + ", its device file states " + number(known) + ": it gives " +
             percent(known / found) + " of the effort asked for, or another mass moves";
    }
    const double least = turns ? kLightest_kgm2 : kLightest_kg;
    const double most = turns ? kHeaviest_kgm2 : kHeaviest_kg;
    return found >= least && found <= most ? std::string() : seen;
  });
  if (out.outcome == Outcome::kPassed && !all_known) {
    return passed("only its order of magnitude: --device FILE states the masses");
  }
  return out;
}

constexpr const char* kWatch =
    "let the drive's watchdog take the effort away on every axis, every time";
using enum DriverStage;

}  // namespace

std::span<const Check> motionChecks() {
  static constexpr Check kChecks[] = {
      {"motion.rests", "while disabled every axis comes to rest",
       "let go of it; look for a drifting encoder", rests, kOpen, Effect::kMoves},
      {"motion.neutral", "at neutral no axis moves off",
       "add no effort; for an arm with a weight give --device FILE with its neutral_effort",
       stillAtNeutral, kEnabled},
      {"motion.moves", "every axis moves when it is pushed by a fifth of its limit",
       "look for a brake, a cable or a wrong limit; an arm that lies on its stop needs --device "
       "FILE",
       moves, kEnabled},
      {"motion.within", "while it is pushed no position leaves its travel",
       "use m and rad, and state the travel it has", staysWithin, kEnabled},
      {"motion.alone", "the axis that is pushed is the one that moves",
       "name motors and encoders as they are wired; decouple the axes in the driver", alone,
       kEnabled},
      {"motion.sign", "every axis moves the way it is pushed",
       "turn the sign of its effort, or of its position", sign, kEnabled},
      {"motion.follows", "the motion follows from the effort asked for",
       "hold each effort until the next command, unchanged", follows, kEnabled},
      {"motion.proportional", "half an effort gives half the acceleration, both ways",
       "pass efforts on unscaled; state the limit that the drive has", proportional, kEnabled},
      {"motion.delay", "every axis answers within its stated delay and 3 ms",
       "state the delay that it has, or send each command at once and unsmoothed", delay, kEnabled},
      {"motion.jumps", "positions go on with the motion, at every speed",
       "hand over the newest position; count a sample as new only where it is", jumps, kEnabled},
      {"motion.measured",
       "the effort measured is the one asked for, on that axis, within a quarter",
       "measure in N and N·m, axis by axis; NaN where the device does not know", measured,
       kEnabled},
      {"motion.mass", "effort and acceleration belong to a mass that can be",
       "send efforts in N and N·m: look at gear and torque constant", mass, kEnabled},
      {"motion.released", "a push ends with its command", "hold an effort until the next command",
       pushReleased, kEnabled},
      {"motion.silence", "a push ends within the watchdog's time, both times", kWatch, pushSilenced,
       kEnabled},
      {"motion.disable", "a push ends with WH_DISABLE",
       "take the effort away before WH_DISABLE returns, on every axis", pushDisabled, kEnabled},
      {"motion.enable", "after a push, WH_DISABLE and WH_ENABLE it stands still, where it was",
       "forget the last command; keep zero and balance", stillEnabledAgain, kEnabled},
      {"motion.close", "a push ends with closing", "neutral and disabled in close", pushClosed,
       kEnabled},
      {"motion.limit", "1.5 times the limit for 5 ms gives no more than the limit",
       "clip to effort_limit on every axis, both ways", pushLimited, kEnabled,
       Effect::kOverreaches},
  };
  return kChecks;
}

}  // namespace wholehand
