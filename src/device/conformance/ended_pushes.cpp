// How a push ends, and what moves at neutral, by the motion of every axis.
#include "device/conformance/ended_pushes.hpp"

#include "device/conformance/motion_judging.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace wholehand {
namespace {

constexpr double kLeft = 0.25;  // of the push
constexpr double kOwn = 0.05;   // of the limit
constexpr double kOver_s = 0.005, kOverShare = 1.5, kClipped = 1.2;
constexpr double kSoon_s = 0.01;  // beyond the stated delay
constexpr double kSilences = 1.5, kSilenceMore_s = 0.02;
constexpr double kLongestReopen_s = 0.3;

// Fails with the axes whose push is not over, in the words of `when`.
CheckFinding over(DriverBench& bench, double allow_s, bool writes, const std::string& when,
                  const std::function<std::string(Course&)>& stop) {
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

}  // namespace

CheckFinding pushReleased(DriverBench& bench) {
  const double allow_s = kSoon_s + longestDelay_s(bench);
  return over(bench, allow_s, true, ms(allow_s) + " after the command went back to neutral",
              [](Course&) { return std::string(); });
}

CheckFinding pushSilenced(DriverBench& bench) {
  if (longestSilence_s(bench) == 0.0) return skipped("states no watchdog");
  const double allow_s = kSilences * longestSilence_s(bench) + kSilenceMore_s;
  return over(bench, allow_s, false, ms(allow_s) + " after the last command", [&](Course&) {
    bench.fallSilent();
    return std::string();
  });
}

CheckFinding pushDisabled(DriverBench& bench) {
  const double allow_s = kSoon_s + longestDelay_s(bench);
  return over(bench, allow_s, false, ms(allow_s) + " after WH_DISABLE", [&](Course&) {
    return bench.control(WH_DISABLE) < 0 ? std::string("WH_DISABLE fails") : std::string();
  });
}

CheckFinding pushClosed(DriverBench& bench) {
  const double allow_s = kSoon_s + longestDelay_s(bench);
  return over(bench, allow_s, false, ms(allow_s) + " after closing", [&](Course& course) {
    const double began_s = course.now_s();
    if (std::string why = bench.reopen(); !why.empty()) return why;
    return course.now_s() - began_s > kLongestReopen_s
               ? std::string("opens again so slowly that a push would have ended at a stop")
               : std::string();
  });
}

namespace {

constexpr double kNeutral_s = 0.1;
constexpr double kEnd = 0.01, kGone = 0.02;  // shares of the travel

// Axes that have left where they rested.
std::string gone(const DriverBench& bench, const Course& course, const std::vector<double>& from) {
  std::string out;
  for (std::size_t a = 0; a < from.size(); ++a) {
    const wh_axis& axis = bench.axes()[a];
    const double moved = course.position(a) - from[a];
    const double most = kGone * (axis.upper - axis.lower) + 3.0 * axis.resolution;
    if (axis.effort_meaning != WH_EFFORT || std::abs(moved) <= most) continue;
    out += (out.empty() ? "" : "; ") + nameOf(bench, a) +
           " was given nothing but neutral, and is " + number(moved) +
           (axis.kind == WH_ROTATION ? " rad" : " m") + " away after " + ms(kNeutral_s);
  }
  return out;
}

// Axes that lie on an end of their travel: an effort into it would not show.
std::string onEnd(const DriverBench& bench, const Course& course) {
  std::string out;
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    const wh_axis& axis = bench.axes()[a];
    const double room = std::min(axis.upper - course.position(a), course.position(a) - axis.lower);
    if (axis.effort_meaning != WH_EFFORT || room > kEnd * (axis.upper - axis.lower)) continue;
    out += (out.empty() ? "" : ", ") + nameOf(bench, a);
  }
  return out.empty() ? out : out + ": on the end of its travel";
}

// From rest to neutral. Returns what is wrong, or why it is not judged.
CheckFinding neutralFromRest(DriverBench& bench) {
  bench.calm();
  if (awaitRest(bench) >= 0) return skipped("does not rest (motion.rests)");
  Course before(bench);
  before.watch(0.002);
  std::vector<double> from;
  for (std::size_t a = 0; a < bench.axes().size(); ++a) from.push_back(before.position(a));
  if (std::string why = bench.reach(DriverStage::kEnabled); !why.empty()) return skipped(why);
  Course course(bench);
  course.push({}, kNeutral_s);
  bench.forgetStalls();
  if (std::string why = gone(bench, course, from); !why.empty()) return failed(why);
  if (course.late()) return skipped("this machine stood still meanwhile");
  const std::string end = onEnd(bench, course);
  return end.empty() ? passed() : skipped(end);
}

}  // namespace

// Where it rests, before anything was pushed; and, with what the pushes tell, in the middle.
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
  const auto stop = [&](Course& course) -> std::string {
    if (bench.control(WH_DISABLE) < 0) return "WH_DISABLE fails";
    if (awaitRest(bench) >= 0) return "does not rest (motion.rests)";
    course.watch(0.002);
    std::vector<double> before;
    for (std::size_t a = 0; a < axes.size(); ++a) before.push_back(course.position(a));
    if (bench.control(WH_ENABLE) < 0) return "cannot be enabled again";
    course.watch(0.002);
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const wh_axis& axis = bench.axes()[a];
      const double steps = std::abs(course.position(a) - before[a]) / axis.resolution;
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

namespace {

// Speed that a pulse beyond the limit gives, over what the limit would give in that time.
double overLimit(DriverBench& bench, const PushedAxis& pushed, std::size_t a, double sign) {
  if (!bench.reach(DriverStage::kEnabled).empty()) return 0.0;
  bringToMiddle(bench, bench.pushed());
  Course course(bench);
  Shares shares{};
  shares.at(a) = sign * kOverShare;
  course.push({}, 0.02);
  const double from_s = course.now_s();
  course.push(shares, kOver_s);
  course.push({}, 0.04);
  const PushTrace trace = course.trace(a, a);
  double given_s = 0.0, ended_s = from_s;
  for (std::size_t i = 0; i + 1 < trace.given.size(); ++i) {
    if (trace.given[i].share == 0.0) continue;
    given_s += trace.given[i + 1].at_s - trace.given[i].at_s;
    ended_s = trace.given[i + 1].at_s;
  }
  if (given_s == 0.0) return 0.0;  // refused
  const double delay_s = pushed.response.delay_s;
  const Parabola before = parabolaThrough(trace, 0.0, from_s);
  const double since_s = ended_s + delay_s + 0.002, until_s = course.now_s();
  const Parabola after = parabolaThrough(trace, since_s, until_s);
  const double middle_s = 0.5 * (since_s + until_s) - ended_s - delay_s;
  const double lost = std::exp(std::max(0.0, pushed.response.damping) * middle_s);
  return sign * (after.speed * lost - before.speed) / (pushed.response.gain * given_s);
}

}  // namespace

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

}  // namespace wholehand
