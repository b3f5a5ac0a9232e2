#include "loop/exercise/finger_walls.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wholehand {
namespace {

/// A finger that is less than this beyond its first touch still gets a wall there [m of path].
constexpr double kPast_m = 1e-3;
/// Release speed of a wall: at least kLetGo_m_s at the tip [m/s], which is 0.04 N per tick for the
/// stiffest shipped wall, and at least the share kLetGo_per_s of its depth per second, which is
/// less than 0.05 N per tick from 9 N on.
constexpr double kLetGo_m_s = 0.15;
constexpr double kLetGo_per_s = 5.0;

/// A wall; lengths are in units of its axis.
struct Wall {
  bool known;
  double position;
};
struct Finger {
  double now, before;  ///< device position now and one tick before
  bool touches;
};

/// Decrease of a wall's depth in a tick of release.
struct Step {
  double least;  ///< the depth decreases by at least this ...
  double share;  ///< ... and this share of its depth
};

/// Wall position at which the finger is no deeper in the wall than before, less the step.
double yieldedPosition(double wall, const Finger& finger, const Step& step) noexcept {
  const double depth = finger.before - wall;
  return std::max(wall,
                  finger.now - std::max(0.0, depth - std::max(step.least, step.share * depth)));
}

/// Releases the wall of a finger that has no touch ahead. The wall exists only as long as it is
/// felt.
Wall letGo(const Wall& wall, const Finger& finger, const Step& step) noexcept {
  const double position = yieldedPosition(wall.position, finger, step);
  return {finger.now > position, position};
}

/// Moves the wall towards its target.
/// @param soft wall of a soft shell with no finger in it: jumps to its target. A finger closes on a
/// shell by up to 40 mm of path, and a moving wall would push it.
double follow(double wall, double target, const Finger& finger, double reach, const Step& step,
              bool soft) noexcept {
  if (soft && finger.now <= wall) return std::max(target, finger.now);
  if (target > wall) {
    const double further = wall + reach;
    return std::min(
        target, finger.touches ? further : std::max(further, yieldedPosition(wall, finger, step)));
  }
  return std::max({target, wall - reach, finger.touches ? target : std::min(wall, finger.now)});
}

}  // namespace

FingerWallState followClosure(const FingerWallState& state, const FingerWallInput& seen,
                              double lead_in_m, double alpha, const FingerWallConfig& config,
                              double elapsed_s) noexcept {
  FingerWallState next{AxisPosition(config.axes), AxisFlag(config.axes), seen.q_m};
  for (int i = 0; i < config.axes; ++i) {
    if (!(config.stiffness[i] > 0.0)) continue;
    const double per_m = 1.0 / config.lever_arm_m[i];
    const bool felt = i < state.known.size() && state.known[i] && alpha > 0.0;
    // A finger before its first touch is not inside, even if the hand model says so.
    const bool inside =
        (seen.inside >> i & 1U) != 0U && i < seen.closure.size() && seen.q_s[i] >= seen.closure[i];
    const bool ahead = i < seen.closure.size() && std::isfinite(seen.closure[i]) &&
                       (inside || seen.q_s[i] <= seen.closure[i] + kPast_m * per_m);
    const Finger finger{seen.q_m[i], felt ? state.finger[i] : seen.q_m[i],
                        inside || (seen.touching >> i & 1U) != 0U};
    const Step step{kLetGo_m_s * per_m * elapsed_s, std::min(1.0, kLetGo_per_s * elapsed_s)};
    Wall wall{felt, felt ? state.position[i] : 0.0};
    // Near the open end the first touch alternates between found and not found: the wall then
    // stays.
    const bool holds = finger.touches && (inside || seen.q_m[i] > seen.q_s[i]) &&
                       i < seen.closure.size() && seen.closure[i] == -HUGE_VAL;
    if (felt && holds) {
      // The wall stays and resists a digit that closes on the target.
    } else if (ahead) {
      double target = seen.closure[i] - lead_in_m * per_m;
      // A wall that moves under a digit would lift it. A wall that stays is a spring, which returns
      // its energy.
      if (inside && felt) target = std::max(target, wall.position);
      const double reach = config.follow_m_s * per_m * elapsed_s;
      wall = {true, felt ? follow(wall.position, target, finger, reach, step, config.soft_m > 0.0)
                         : std::max(target, finger.now)};
    } else if (felt) {
      wall = letGo(wall, finger, step);
    }
    next.known[i] = wall.known;
    next.position[i] = wall.known ? wall.position : 0.0;
  }
  return next;
}

}  // namespace wholehand
