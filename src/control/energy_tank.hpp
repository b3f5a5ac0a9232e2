#pragma once

#include "control/coupling_gains.hpp"
#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/device_model.hpp"

#include <array>

namespace wholehand {

/// A storage-aware energy tank: the loop gives to person and world what they put in and what it
/// stores, and a little besides; when a tank is empty, damping takes back what the loop makes of
/// nothing. Two accounts stand side by side.
///
/// Each axis: does its coupling, sampled and delayed, make energy between the person and the
/// avatar?
///   E ← E − f Δq_m − a Δq_s − (S − S⁻) − h + b v² kT,   within ±Ê
/// The hand: does the person get more energy out of the hand, by whatever axis, than was put in by
/// whatever axis? It trusts neither avatar nor world, and lets them hold what a passive one can.
///   H ← H − Σ (f Δq_m + (S − S⁻) + h − b v² kT),        within ±Ĥ
///
/// f: the effort that acted on the device since the last tick; its delay counted, its weight not.
/// a = K_pm e + D ė: what drives the avatar, e = q_m − q_s. f is held to the effort limit f̂; so is
/// a in the account: otherwise a saturated axis runs into a debt that nothing repays.
/// S = K_pm e²/2, beyond f̂ only f̂|e| − f̂²/(2 K_pm); and what the walls of an exercise store.
/// h = ½ δ |f − f⁻|: what an encoder of steps δ hides. By partial summation f Δq_m differs from the
/// work done by at most δ/2 for each unit that f changes; a limit cycle of δ/(2T) lives on it.
/// b v² kT: what the device's own damping takes, v the velocity behind a low-pass of 2 ms. A
/// low-pass of unit gain never adds energy, so this is never more than the damper took.
///
/// An account below 0 damps: f_t = −min(debt/(v² kT), α̂) v. It grows by what else is given.
/// The most whole samples between sending an effort and its effect.
inline constexpr int kMostDelayTicks = 8;

struct EnergyTankConfig {
  int axes = 0;
  int delay_ticks = 0;
  AxisEnergy capacity;         ///< Ê [J]
  double hand_capacity = 0.0;  ///< Ĥ [J]
  AxisRatio device_damping;    ///< b [N·s/m or N·m·s/rad]
  AxisPosition encoder_step;   ///< δ
  AxisRatio most_damping;      ///< α̂: more would ring, or make one count of the encoder be felt
};

/// Ê = f̂ d/2 with d = 5 mm, at the tip where the axis has one, or 0.05 rad: what a push up to the
/// limit over d puts into a spring. A wall of an exercise that fades in under a finger lives on it.
/// α̂ = 0.4 m/((1 + n) T + 2 ms), and at most so much that one count of the encoder makes 2 % of f̂.
/// @param held_j what avatar and world can hold; Ĥ is this and the sum of Ê
[[nodiscard]] EnergyTankConfig makeEnergyTank(const DeviceModel& device, double period_s,
                                              double held_j);

struct EnergyTankState {
  AxisEnergy energy;  ///< E
  double hand = 0.0;  ///< H [J]
  AxisEnergy stored;  ///< S
  AxisPosition q_m, q_s;
  AxisVelocity velocity;                               ///< v
  AxisEffort avatar;                                   ///< a, since the last tick
  std::array<AxisEffort, kMostDelayTicks + 2> sent{};  ///< without the device's weight; a ring
  int newest = 0;
  bool fresh = true;  ///< nothing is known of the tick before
};

/// Full, as at the start, after a pause, and while an effort is blended in. Real-time safe.
[[nodiscard]] WHOLEHAND_RT EnergyTankState fullTank(const EnergyTankConfig& config) noexcept;

struct EnergyTankStep {
  EnergyTankState state;
  AxisEffort effort;  ///< damping of an empty tank, to be added; 0 where there is energy left
};

/// One tick, before the effort is limited. Pure, real-time safe.
/// @param effort_limit f̂, in force now
/// @param wall_stored what the walls of an exercise hold, α k p²/2 per axis [J]; size 0: none
[[nodiscard]] WHOLEHAND_RT EnergyTankStep advanceTank(
    const EnergyTankState& state, const AxisPosition& q_m, const AxisPosition& q_s,
    const AxisEnergy& wall_stored, const CouplingGains& gains, const EnergyTankConfig& config,
    const AxisEffort& effort_limit, int elapsed_periods, double period_s) noexcept;

/// Tells the tank what was sent and what drives the avatar. Once a tick, after advanceTank().
/// @param sent without the device's own weight
/// @param avatar_effort f_s, Eq. (2) @param effort_limit f̂, in force now
[[nodiscard]] WHOLEHAND_RT EnergyTankState noteSent(const EnergyTankState& state,
                                                    const AxisEffort& sent,
                                                    const AxisEffort& avatar_effort,
                                                    const AxisEffort& effort_limit) noexcept;

}  // namespace wholehand
