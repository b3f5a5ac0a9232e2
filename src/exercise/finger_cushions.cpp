#include "exercise/finger_cushions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand {

Bottle readBottle(TomlTable& table) {
  Bottle out;
  out.area_m2 = table.number("area_m2", above(0.0, 0.01, "m²"));
  out.return_n_m = table.number("return_n_m", above(0.0, 1e4, "N/m"));
  out.opening_n = table.number("opening_n", between(0.0, 10.0, "N"));
  out.air_s = table.number("air_s", between(0.05, 5.0, "s"), out.air_s);
  out.nozzle.length_m = table.number("nozzle_length_m", above(0.0, 1.0, "m"));
  out.nozzle.radius_m = table.number("nozzle_radius_m", above(0.0, 0.1, "m"));
  return out;
}

Bottle readLiquid(TomlTable& table, Bottle bottle) {
  bottle.nozzle.viscosity_pa_s = table.number("viscosity_pa_s", above(0.0, 1e3, "Pa·s"));
  if (table.isGood("viscosity_pa_s") && bottle.resistance() < kLeastFelt_n_s_m) {
    table.fail(
        "viscosity_pa_s",
        fmt::format("gives {:.3g} N·s/m at the fingertip, which is not felt", bottle.resistance()),
        fmt::format("raise it, or make the nozzle longer or narrower: at least {:g} N·s/m",
                    kLeastFelt_n_s_m));
  }
  return bottle;
}

std::vector<Cushion> cushionsOf(const Bottle& bottle, const FingerWallConfig& walls) {
  std::vector<Cushion> out(static_cast<std::size_t>(walls.axes));
  for (int i = 0; i < walls.axes; ++i) {
    const double arm = walls.lever_arm_m[i], square = arm * arm;
    out[i] = {walls.stiffness[i], bottle.return_n_m * square, bottle.resistance() * square,
              bottle.air_s * bottle.return_n_m * square, bottle.opening_n * arm};
  }
  return out;
}

std::vector<ExerciseWall> stiffestCushions(const Bottle& bottle, const FingerWallConfig& walls) {
  std::vector<ExerciseWall> out = stiffestWalls(walls);
  const std::vector<Cushion> cushions = cushionsOf(bottle, walls);
  for (ExerciseWall& wall : out) {
    const Cushion& cushion = cushions[wall.axis];
    wall.resistance = std::min(kThinnestRatio * cushion.resistance, cushion.air_resistance);
  }
  return out;
}

BottlePress pressBottle(const AxisPosition& travel, const FingerWallState& walls,
                        const AxisPosition& q_m, std::uint32_t open, double alpha,
                        const CushionRatios& ratios, const std::vector<Cushion>& cushions,
                        double area_m2, const FingerWallConfig& config, double elapsed_s) noexcept {
  BottlePress out{AxisPosition(config.axes), AxisEffort(config.axes), 0.0, 0.0};
  for (int i = 0; i < config.axes; ++i) {
    Cushion cushion = cushions[i];
    cushion.stiffness *= ratios.stiffness;
    cushion.opening *= ratios.opening;
    cushion.resistance =
        ratios.empty ? std::min(cushion.resistance, cushion.air_resistance)
                     : ratios.viscosity * cushion.resistance;
    const double before = i < travel.size() ? travel[i] : 0.0;
    const double depth = walls.known[i] ? q_m[i] - walls.position[i] : 0.0;
    const CushionStep step =
        advanceCushion(cushion, before, depth, (open >> i & 1U) != 0U, elapsed_s);
    out.travel[i] = step.travel;
    out.effort[i] = -alpha * std::min(step.effort, config.effort_cap[i]);
    const double m3 = alpha * area_m2 * config.lever_arm_m[i];
    out.out_m3 += m3 * std::max(0.0, step.travel - before);
    out.pressed_m3 += m3 * step.travel;
  }
  return out;
}

}  // namespace wholehand
