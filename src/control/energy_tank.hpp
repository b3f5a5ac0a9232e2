#pragma once

#include "control/coupling_gains.hpp"
#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/device_model.hpp"

#include <array>

namespace wholehand {

/// A storage-aware energy tank per axis: it lets the loop give to person and world what they put in
/// and what the springs hold, and a little besides; when it is empty, damping takes back what the
/// loop makes of nothing.
///
///   S = K_pm e²/2, beyond the effort limit f̂ only f̂|e| − f̂²/(2 K_pm); and what the wall stores
///   E ← min(Ê, E − f Δq_m − a Δq_s − (S − S⁻) − ½ δ |f − f⁻| + ½ b Δq_m²/(kT))
///   E ≥ −Ê: a debt is not remembered for ever
///   E < 0:  f_t = −min(−E kT/Δq_m², α̂) Δq_m/(kT)
///
/// e = q_m − q_s, f the effort that acted on the device since the last tick (its output delay
/// counted, its own weight not), a = K_pm e + D ė what drove the avatar, b the device's damping, δ
/// its encoder's step. What an encoder of steps hides is the fifth term: by partial summation f
/// Δq_m differs from the work done by at most δ/2 for each unit that f changes, and a loop with a
/// delayed effort finds a limit cycle of δ/(2T) that lives on it. Without the bound on S a
/// saturated spring would count energy that nobody put in, and the tank would damp a stable loop.

/// The most whole samples between sending an effort and its effect.
inline constexpr int kMostDelayTicks = 8;

struct EnergyTankConfig {
  int axes = 0;
  int delay_ticks = 0;
  AxisEnergy capacity;        ///< Ê [J]
  AxisRatio device_damping;   ///< b [N·s/m or N·m·s/rad]
  AxisPosition encoder_step;  ///< δ
  AxisRatio most_damping;     ///< α̂: more would ring; 0.4 m/((1 + n) T)
};

/// Ê = 50 mJ on translations, 5 mJ on rotations: what a push of 10 N over 5 mm puts into a spring.
[[nodiscard]] EnergyTankConfig makeEnergyTank(const DeviceModel& device, double period_s);

struct EnergyTankState {
  AxisEnergy energy;  ///< E
  AxisEnergy stored;  ///< S
  AxisPosition q_m, q_s;
  AxisEffort avatar;                                   ///< a, since the last tick
  std::array<AxisEffort, kMostDelayTicks + 2> sent{};  ///< without the device's weight; a ring
  int newest = 0;
  bool fresh = true;  ///< nothing is known of the tick before
};

/// Full, as at the start, after a pause, and while an effort is blended in. Real-time safe.
[[nodiscard]] WHOLEHAND_RT EnergyTankState fullTank(const EnergyTankConfig& config) noexcept;

struct EnergyTankStep {
  EnergyTankState state;
  AxisEffort effort;  ///< damping of the empty tank, to be added; 0 where there is energy left
};

/// One tick, before the effort is limited. Pure, real-time safe.
/// @param effort_limit f̂, in force now
/// @param wall_stored what the walls of an exercise hold, α k p²/2 per axis [J]; size 0: none
[[nodiscard]] WHOLEHAND_RT EnergyTankStep advanceTank(
    const EnergyTankState& state, const AxisPosition& q_m, const AxisPosition& q_s,
    const AxisEnergy& wall_stored, const CouplingGains& gains, const EnergyTankConfig& config,
    const AxisEffort& effort_limit, int elapsed_periods, double period_s) noexcept;

/// Tells the tank what was sent and what drives the avatar. Once a tick, after advanceTank().
/// @param sent without the device's own weight @param qd_mf, qd_s, avatar_damping as in Eq. (2)
[[nodiscard]] WHOLEHAND_RT EnergyTankState noteSent(
    const EnergyTankState& state, const AxisEffort& sent, const AxisVelocity& qd_mf,
    const AxisVelocity& qd_s, const AxisRatio& avatar_damping, const CouplingGains& gains) noexcept;

}  // namespace wholehand
