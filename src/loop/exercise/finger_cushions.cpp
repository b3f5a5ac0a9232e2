#include "loop/exercise/finger_cushions.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// Largest speed at which a shell gives way, at the tip (pressBottle()).
constexpr double kFastest_m_s = 0.14;

}  // namespace

Cushions cushionsOf(const Bottle& bottle, const FingerWallConfig& walls) {
  Cushions out{{}, {}, {}, walls.effort_cap};
  for (int i = 0; i < walls.axes; ++i) {
    const double arm = walls.lever_arm_m[i], square = arm * arm;
    out.axes.push_back({walls.stiffness[i], bottle.return_n_m * square,
                        bottle.resistance() * square, bottle.air_s * bottle.return_n_m * square,
                        bottle.opening_n * arm});
    out.out_m3.push_back(bottle.area_m2 * arm);
    out.fastest.push_back(kFastest_m_s / arm);
  }
  return out;
}

std::vector<ExerciseWall> stiffestCushions(const Bottle& bottle, const FingerWallConfig& walls) {
  std::vector<ExerciseWall> out;
  const Cushions cushions = cushionsOf(bottle, walls);
  for (int i = 0; i < walls.axes; ++i) {
    const Cushion& cushion = cushions.axes[i];
    if (!(cushion.stiffness > 0.0)) continue;
    out.push_back({i, kLargestWallRatio * cushion.stiffness, 0.0,
                   std::min(kThinnestRatio * cushion.resistance, cushion.air_resistance)});
  }
  return out;
}

BottlePress pressBottle(const AxisPosition& travel, const BottleInput& seen,
                        const Cushions& cushions) noexcept {
  const int axes = seen.q_m.size();
  BottlePress out{AxisPosition(axes), AxisEffort(axes), 0.0, 0.0};
  for (int i = 0; i < axes; ++i) {
    Cushion cushion = cushions.axes[i];
    cushion.stiffness *= seen.ratios.stiffness;
    cushion.opening *= seen.ratios.opening;
    cushion.resistance *= seen.ratios.viscosity;
    if (seen.empty) cushion.resistance = std::min(cushion.resistance, cushion.air_resistance);
    cushion.resistance /= seen.slit;
    const double before = i < travel.size() ? travel[i] : 0.0;
    const double depth = seen.walls.known[i] ? seen.q_m[i] - seen.walls.position[i] : 0.0;
    const bool open = (seen.open >> i & 1U) != 0U;
    CushionStep step = advanceCushion(cushion, before, depth, open, seen.elapsed_s);
    const double most = cushions.fastest[i] * seen.elapsed_s;
    if (cushion.stiffness > 0.0 && std::abs(step.travel - before) > most) {
      step.travel = std::clamp(step.travel, before - most, before + most);
      step.effort = std::max(0.0, cushion.stiffness * (std::max(0.0, depth) - step.travel));
    }
    out.travel[i] = step.travel;
    out.effort[i] = -seen.alpha * std::min(step.effort, cushions.effort_cap[i]);
    const double m3 = seen.alpha * cushions.out_m3[i];
    out.out_m3 += m3 * std::max(0.0, step.travel - before);
    out.pressed_m3 += m3 * step.travel;
  }
  return out;
}

}  // namespace wholehand
