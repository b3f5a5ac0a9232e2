#pragma once

#include "loop/core/real_time.hpp"

namespace wholehand {

/// Squeeze bottle under one digit: an elastic shell that presses a liquid out through a nozzle. The
/// viscosity of the liquid is in series with the shell. Units of its axis [m or rad], [N or N·m].
struct Cushion {
  double stiffness = 0.0;         ///< k of the shell under the digit, >= 0
  double return_stiffness = 0.0;  ///< k_s: spring that restores the shell, >= 0
  double resistance = 0.0;        ///< d: resistance of the liquid [N·s/m or N·m·s/rad], > 0
  double air_resistance = 0.0;    ///< d_air: resistance of the air that flows back, > 0
  double opening = 0.0;           ///< p₀: effort below which the valve stays closed, >= 0
};

struct CushionStep {
  double travel = 0.0;  ///< y: liquid displaced, as travel of the digit; >= 0
  double effort = 0.0;  ///< f = max(0, k (x - y)), against closing
};

/// Advances a cushion by one tick, backward Euler in closed form. With q = f - k_s y:
///   d ẏ = q - p₀ where q > p₀ and the nozzle is open,  d_air ẏ = q where q < 0,  else ẏ = 0.
/// The travel is the only solution, because q falls as y rises. For any motion of the digit, and
/// for a nozzle and resistances that change from tick to tick:
///   f⁺ Δx >= ΔS,   f Δx >= ΔS - k Δx²/2,   S = f²/2k + k_s y²/2.
/// The first inequality holds because f⁺ Δx − ΔS >= q⁺ Δy + (k (Δx − Δy)² + k_s Δy²)/2 and q⁺ Δy >=
/// 0. The second holds because f Δx − ΔS = q⁺ Δy + (k + k_s) Δy²/2 − k Δx²/2. So the cushion is
/// passive; with its effort held for a tick it gives no more energy than its bare spring k.
/// Non-finite input gives an empty step: no travel, no effort. Pure, real-time safe.
/// @param travel y one tick before @param depth x: position of the digit behind its first touch
/// @param open the nozzle is open; while it is closed, only air flows
[[nodiscard]] WHOLEHAND_RT CushionStep advanceCushion(const Cushion& cushion, double travel,
                                                      double depth, bool open,
                                                      double elapsed_s) noexcept;

/// Damping that a cushion needs because of a delay of n ticks, in addition to that of its bare
/// spring: n² k² T²/4d, with d the smallest of its resistances [N·s/m or N·m·s/rad]. 0 without
/// delay. Compared with a delayed spring, the delayed effort misses the additional work k (y −
/// y⁽ⁿ⁾) Δx. The liquid dissipates d Δy²/T; spread over n ticks in equal parts, this covers all of
/// that work but n² k² T Δx²/4d. The same holds at any frequency for H(z) = k (1 − T k/(d + T (k +
/// k_s) − d z⁻¹)) in place of k.
[[nodiscard]] double lateDamping(double stiffness, double least_resistance, int delay_ticks,
                                 double period_s) noexcept;

/// A nozzle and the liquid in it.
struct Nozzle {
  double viscosity_pa_s = 0.0;  ///< η
  double length_m = 0.0;        ///< L
  double radius_m = 0.0;        ///< r
};

/// d = 8 η L A²/(π r⁴), Hagen and Poiseuille, felt on an area A [N·s/m].
[[nodiscard]] double nozzleResistance(const Nozzle& nozzle, double area_m2) noexcept;

}  // namespace wholehand
