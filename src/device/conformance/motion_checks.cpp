// Checks by what moves: each axis is pushed by up to kEffortShare of its limit while nobody holds
// it, and its own positions are held against what was asked. Bits and measured efforts count for
// nothing here, but in motion.measured.
#include "device/conformance/ended_pushes.hpp"
#include "device/conformance/motion_judging.hpp"

#include <cmath>

namespace wholehand {
namespace {

constexpr double kAlong = 0.25;         // of another axis, over its own response
constexpr double kAlike = 0.3;          // gains of pushes of other sizes and the other way
constexpr double kUnexplained = 0.11;   // share of the motion
constexpr double kDelayMore_s = 0.003;  // two periods of the loop, and what the fit leaves open
constexpr double kMeasuredWithin = 0.25;
constexpr double kMassWithin = 1.5;  // times, and its inverse
constexpr double kRubs = 0.25;       // of the push: dry friction that hides what is asked here
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
    // Dry friction turns no push round, and what rubs as much as the push does not move at all.
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

// Effort over acceleration is the mass: it tells a wrong unit; with a device file, any wrong
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
constexpr Effect kMoves = Effect::kMoves;
constexpr DriverStage kEnabled = DriverStage::kEnabled;

constexpr Check kChecks[] = {
    {"motion.rests", "while disabled every axis comes to rest",
     "let go of it; look for a drifting encoder", kMoves, DriverStage::kOpen, rests},
    {"motion.neutral", "at neutral no axis moves off",
     "add no effort; for an arm with a weight give --device FILE with its neutral_effort", kMoves,
     kEnabled, stillAtNeutral},
    {"motion.moves", "every axis moves when it is pushed by a fifth of its limit",
     "look for a brake, a cable or a wrong limit; an arm that lies on its stop needs --device FILE",
     kMoves, kEnabled, moves},
    {"motion.within", "while it is pushed no position leaves its travel",
     "use m and rad, and state the travel it has", kMoves, kEnabled, staysWithin},
    {"motion.alone", "the axis that is pushed is the one that moves",
     "name motors and encoders as they are wired; decouple the axes in the driver", kMoves,
     kEnabled, alone},
    {"motion.sign", "every axis moves the way it is pushed",
     "turn the sign of its effort, or of its position", kMoves, kEnabled, sign},
    {"motion.follows", "the motion follows from the effort asked for",
     "hold each effort until the next command, unchanged", kMoves, kEnabled, follows},
    {"motion.proportional", "half an effort gives half the acceleration, both ways",
     "pass efforts on unscaled; state the limit that the drive has", kMoves, kEnabled,
     proportional},
    {"motion.delay", "every axis answers within its stated delay and 3 ms",
     "state the delay that it has, or send each command at once and unsmoothed", kMoves, kEnabled,
     delay},
    {"motion.jumps", "positions go on with the motion, at every speed",
     "hand over the newest position; count a sample as new only where it is", kMoves, kEnabled,
     jumps},
    {"motion.measured", "the effort measured is the one asked for, on that axis, within a quarter",
     "measure in N and N·m, axis by axis; NaN where the device does not know", kMoves, kEnabled,
     measured},
    {"motion.mass", "effort and acceleration belong to a mass that can be",
     "send efforts in N and N·m: look at gear and torque constant", kMoves, kEnabled, mass},
    {"motion.released", "a push ends with its command", "hold an effort until the next command",
     kMoves, kEnabled, pushReleased},
    {"motion.silence", "a push ends within the watchdog's time, both times", kWatch, kMoves,
     kEnabled, pushSilenced},
    {"motion.disable", "a push ends with WH_DISABLE",
     "take the effort away before WH_DISABLE returns, on every axis", kMoves, kEnabled,
     pushDisabled},
    {"motion.enable", "after a push, WH_DISABLE and WH_ENABLE it stands still, where it was",
     "forget the last command; keep zero and balance", kMoves, kEnabled, stillEnabledAgain},
    {"motion.close", "a push ends with closing", "neutral and disabled in close", kMoves, kEnabled,
     pushClosed},
    {"motion.limit", "1.5 times the limit for 5 ms gives no more than the limit",
     "clip to effort_limit on every axis, both ways", Effect::kOverreaches, kEnabled, pushLimited},
};

}  // namespace

std::span<const Check> motionChecks() {
  return kChecks;
}

}  // namespace wholehand
