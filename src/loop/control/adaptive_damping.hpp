#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/rendering_config.hpp"

#include <vector>

namespace wholehand {

/// Algorithm 1 for one axis as a one-state recursion: φ ← max(ρ, e^{−kT/τ} φ), ρ = clamp((|f| −
/// f_d)/(f₀ − f_d), 0, 1). A non-finite effort counts as ρ = 1 (more damping is the safe side).
/// With f₀ ≤ f_d, ρ is a step at f_d. With τ ≤ 0, φ decays at once. Pure, real-time safe.
/// @param elapsed_periods k = 1 + skipped ticks.
[[nodiscard]] WHOLEHAND_RT double activate(double phi, double effort, double effort_dead,
                                           double effort_full, double decay_s, int elapsed_periods,
                                           double period_s) noexcept;

/// Parameters per axis, in plain arrays for the tick.
struct AdaptiveDampingConfig {
  int axes = 0;
  AxisEffort effort_dead;  ///< f_d
  AxisEffort effort_full;  ///< f₀
  AxisTime decay_s;        ///< τ_dec
  AxisFlag hand_axis;      ///< true: drives joints of the hand; false: base axis
  AxisFlag palm_contact;   ///< true: the base axis also has its own φ
};
[[nodiscard]] AdaptiveDampingConfig makeAdaptiveDamping(const DeviceModel& device,
                                                        const RenderingConfig& rendering);

struct AdaptiveDampingState {
  AxisRatio own;  ///< φ of each axis by Algorithm 1
  AxisRatio phi;  ///< diagonal of Φ, Eq. (5)
};

/// Algorithm 1 on every axis, then Eq. (5). A hand axis uses its own φ. A base axis uses the
/// largest φ of the hand axes; its own without hand axes; the larger of both where palm_contact is
/// set. Pure, real-time safe.
/// @param effort f_coupling + f_e, without the damping term (φ must not feed back on itself).
[[nodiscard]] WHOLEHAND_RT AdaptiveDampingState adaptDamping(const AdaptiveDampingState& state,
                                                             const AxisEffort& effort,
                                                             const AdaptiveDampingConfig& config,
                                                             int elapsed_periods,
                                                             double period_s) noexcept;

}  // namespace wholehand
