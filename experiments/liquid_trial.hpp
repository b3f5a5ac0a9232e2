#pragma once

#include "loop/core/expected.hpp"
#include "rig/rig.hpp"

#include <array>
#include <complex>
#include <string>
#include <vector>

namespace wholehand {

/// Rendering of a bar's liquid including the device, at the tip. The shipped loop runs around a
/// device that closes one digit by a script while the other digit holds against it.
struct LiquidFelt {
  std::string liquid;
  double resistance_n_s_m = 0.0;  ///< d from the file
  std::array<double, 2>
      felt_n_s_m{};  ///< fingers, thumb: force divided by speed in a steady squeeze
  std::complex<double> stiffness_n_m;  ///< fingers: force divided by path at 0.5 Hz
  /// Force versus path of the fingers at the same speed for every liquid: {mm, N}.
  std::vector<std::array<double, 2>> squeeze;
};

inline constexpr double kLiquidHz = 0.5;
/// Speed of LiquidFelt::squeeze.
inline constexpr double kSqueeze_m_s = 0.006;

/// Measures every liquid of the exercise's last level. Returns an error for an exercise without
/// dispensers or a device without fingers or thumb.
[[nodiscard]] Expected<std::vector<LiquidFelt>> feelLiquids(const ModelFiles& files);

/// |ΔZ|/|Z| of two liquids at kLiquidHz.
[[nodiscard]] double impedanceChange(const LiquidFelt& thinner, const LiquidFelt& thicker);

/// Share of correct answers of an Observer who compares both liquids once, with Jones's σ of 0.222
/// for the logarithm of viscosity.
[[nodiscard]] double distinguishedShare(double ratio);

}  // namespace wholehand
