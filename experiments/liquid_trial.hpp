#pragma once

#include "loop/core/expected.hpp"
#include "rig/rig.hpp"

#include <array>
#include <complex>
#include <string>
#include <vector>

namespace wholehand {

/// What a person feels of a bar's liquid, device included: the shipped loop around a device that
/// closes one digit by a script, while the other one holds against it. At the tip.
struct LiquidFelt {
  std::string liquid;
  double resistance_n_s_m = 0.0;       ///< d of the file
  std::array<double, 2> felt_n_s_m{};  ///< fingers, thumb: force over speed of a steady squeeze
  std::complex<double> stiffness_n_m;  ///< fingers: force over path at 0.5 Hz
  /// Force over path at the same speed for every liquid: {mm, N} of the fingers.
  std::vector<std::array<double, 2>> squeeze;
};

inline constexpr double kLiquidHz = 0.5;
/// Speed of LiquidFelt::squeeze.
inline constexpr double kSqueeze_m_s = 0.006;

/// Feels every liquid of the exercise's last level. Refused for an exercise without dispensers, or
/// a device without fingers or thumb.
[[nodiscard]] Expected<std::vector<LiquidFelt>> feelLiquids(const ModelFiles& files);

/// |ΔZ|/|Z| of two liquids at kLiquidHz.
[[nodiscard]] double impedanceChange(const LiquidFelt& thinner, const LiquidFelt& thicker);

/// Share of right answers of an observer with Jones's σ of 0.222 of a viscosity's logarithm, who
/// feels both liquids once: Φ(ln(ratio)/(√2 σ)).
[[nodiscard]] double toldApart(double ratio);

}  // namespace wholehand
