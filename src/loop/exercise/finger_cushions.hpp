#pragma once

#include "loop/control/viscoelastic.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/exercise/exercise.hpp"
#include "loop/exercise/finger_walls.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// A squeeze bottle: a cushion behind every finger wall; all cushions share one nozzle.
struct Bottle {
  double area_m2 = 0.0;     ///< A: area of a digit on the liquid
  double return_n_m = 0.0;  ///< k_s at the tip
  double opening_n = 0.0;   ///< p₀ A: force of each digit that opens the valve
  double air_s = 0.0;       ///< time constant of the air that flows back
  Nozzle nozzle;

  /// d at the tip [N·s/m].
  [[nodiscard]] double resistance() const { return nozzleResistance(nozzle, area_m2); }
};

/// Range of the live parameter that scales the liquid's viscosity.
inline constexpr double kThinnestRatio = 0.1, kThickestRatio = 2.0;
/// A liquid with less resistance at the tip is not felt [N·s/m].
inline constexpr double kLeastFelt_n_s_m = 1.0;

[[nodiscard]] inline Bottle filledWith(Bottle bottle, double viscosity_pa_s) {
  bottle.nozzle.viscosity_pa_s = viscosity_pa_s;
  return bottle;
}

/// The cushions of a bottle behind the walls, in the axes' units.
struct Cushions {
  std::vector<Cushion> axes;   ///< no stiffness where the axis has no wall
  std::vector<double> out_m3;  ///< liquid per travel of an axis [m³ per m or rad]
  /// Largest speed at which the cushion's travel may change [m/s or rad/s]
  std::vector<double> fastest;
  AxisEffort effort_cap;
};
[[nodiscard]] Cushions cushionsOf(const Bottle& bottle, const FingerWallConfig& walls);

/// The walls with the live parameters at their stiffest, as the certificate covers them: every
/// liquid from the thinnest to the one behind a closed nozzle.
[[nodiscard]] std::vector<ExerciseWall> stiffestCushions(const Bottle& bottle,
                                                         const FingerWallConfig& walls);

/// Factors by which live parameters scale the values of the exercise file.
struct CushionRatios {
  double stiffness = 1.0, viscosity = 1.0, opening = 1.0;
};

/// Input of a bottle in a tick.
struct BottleInput {
  const FingerWallState& walls;
  const AxisPosition& q_m;
  double alpha = 1.0;
  std::uint32_t open = 0;  ///< bit a: the nozzle is open for axis a
  double slit = 1.0;       ///< share of the nozzle that is open, 0 .. 1
  bool empty = false;      ///< the bottle holds air instead of liquid
  CushionRatios ratios;
  double elapsed_s = 0.0;
};

/// Reaction of a bottle in a tick.
struct BottlePress {
  AxisPosition travel;      ///< y of each axis
  AxisEffort effort;        ///< f_e of each axis, against closing
  double out_m3 = 0.0;      ///< liquid that left through the nozzle in this tick, >= 0
  double pressed_m3 = 0.0;  ///< volume by which the shell is pressed in
};

/// Advances the cushions behind the walls by one tick. α scales the effort and the liquid equally.
/// An axis without a wall releases its cushion. No shell gives way faster than 0.14 m/s at the tip,
/// whatever opens: the liquid then acts as if it were thicker in that tick. The effort of a wall of
/// 336 N/m therefore falls by less than 0.05 N per millisecond. Pure, real-time safe.
/// @param travel y one tick before; size 0: none
[[nodiscard]] WHOLEHAND_RT BottlePress pressBottle(const AxisPosition& travel,
                                                   const BottleInput& seen,
                                                   const Cushions& cushions) noexcept;

}  // namespace wholehand
