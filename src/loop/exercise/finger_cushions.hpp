#pragma once

#include "loop/control/viscoelastic.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/exercise/exercise.hpp"
#include "loop/exercise/finger_walls.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// A squeeze bottle: behind every finger wall a cushion of its own, all on one nozzle.
struct Bottle {
  double area_m2 = 0.0;     ///< A: a digit's, on the liquid
  double return_n_m = 0.0;  ///< k_s at the tip
  double opening_n = 0.0;   ///< p₀ A: the valve's, of each digit
  double air_s = 0.0;       ///< time constant of the air that flows back
  Nozzle nozzle;

  /// d at the tip [N·s/m].
  [[nodiscard]] double resistance() const { return nozzleResistance(nozzle, area_m2); }
};

/// Upper and lower end of the live factor on the liquid's viscosity.
inline constexpr double kThinnestRatio = 0.1, kThickestRatio = 2.0;
/// A liquid of less resistance at the tip is not felt [N·s/m].
inline constexpr double kLeastFelt_n_s_m = 1.0;

[[nodiscard]] inline Bottle filledWith(Bottle bottle, double viscosity_pa_s) {
  bottle.nozzle.viscosity_pa_s = viscosity_pa_s;
  return bottle;
}

/// The cushions of a bottle behind the walls, in the axes' units.
struct Cushions {
  std::vector<Cushion> axes;    ///< no stiffness where the axis has no wall
  std::vector<double> out_m3;   ///< liquid per travel of an axis [m³ per m or rad]
  std::vector<double> fastest;  ///< largest speed of an axis's travel [m/s or rad/s]
  AxisEffort effort_cap;
};
[[nodiscard]] Cushions cushionsOf(const Bottle& bottle, const FingerWallConfig& walls);

/// The walls with the live parameters at their stiffest, as covered by the certificate: every
/// liquid from the thinnest to a closed nozzle.
[[nodiscard]] std::vector<ExerciseWall> stiffestCushions(const Bottle& bottle,
                                                         const FingerWallConfig& walls);

/// Factors on the file's numbers.
struct CushionRatios {
  double stiffness = 1.0, viscosity = 1.0, opening = 1.0;
};

/// What a bottle meets in a tick.
struct BottleInput {
  const FingerWallState& walls;
  const AxisPosition& q_m;
  double alpha = 1.0;
  std::uint32_t open = 0;  ///< bit a: the nozzle is open to axis a
  double slit = 1.0;       ///< share by which it is open there, 0 .. 1
  bool empty = false;      ///< air in place of the liquid
  CushionRatios ratios;
  double elapsed_s = 0.0;
};

/// What the digits do to a bottle in a tick.
struct BottlePress {
  AxisPosition travel;      ///< y of each axis
  AxisEffort effort;        ///< f_e of each axis, against closing
  double out_m3 = 0.0;      ///< liquid out of the nozzle, >= 0
  double pressed_m3 = 0.0;  ///< what the shell is pressed in by
};

/// Advances the cushions behind the walls by one tick. α scales the effort and the liquid alike. An
/// axis without a wall has let its cushion go. No shell gives way by more than 0.14 m/s at the tip,
/// so that the effort of a wall of 336 N/m falls by less than 0.05 N a millisecond, whatever opens:
/// as if the liquid were thicker in that tick. Pure, real-time safe.
/// @param travel y a tick before; size 0: none
[[nodiscard]] WHOLEHAND_RT BottlePress pressBottle(const AxisPosition& travel,
                                                   const BottleInput& seen,
                                                   const Cushions& cushions) noexcept;

}  // namespace wholehand
