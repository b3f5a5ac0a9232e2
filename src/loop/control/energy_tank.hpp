#pragma once

#include "loop/control/bilateral_coupling.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/device_model.hpp"

#include <array>

namespace wholehand {

/// Storage-aware energy tank. The loop may return the energy that person and world put in, the
/// energy it stores, and the content of its tanks. When a tank is empty, added damping dissipates
/// the energy that the loop generates. There are two kinds of tank.
///
/// Each axis has a tank. It balances the energy that the sampled and delayed coupling generates
/// between person and avatar:
///   E ← E − f Δq_m − a Δq_s − (S − S⁻) − h + b v² kT,   within ±Ê
/// The hand has one tank. It balances the energy that the person receives over all axes against the
/// energy that the person (over all axes) and other sources put into the world. It assumes neither
/// avatar nor world passive. Its content never exceeds the energy that they hold by more than its
/// capacity:
///   H ← H − Σ (f Δq_m + (S − S⁻) + h − b v² kT) + W,    within −Ĥ .. Ĥ + K
///
/// K: energy that avatar and world hold. W: energy that other sources put in since the last tick:
/// gravity and a game into the world, an exercise that pushes into the hand. Friction in the world
/// only lowers the upper end of H; energy that the world generates by itself never raises H.
///
/// f: effort that acted on the device since the last tick, output delay included, the device's
/// weight excluded.
/// a = K_pm e + D ė: effort on the avatar, e = q_m − q_s. Both f and a are clamped to the effort
/// limit f̂; otherwise a saturated axis accumulates a debt that nothing repays.
/// S: stored energy, K_pm e²/2, beyond f̂ only f̂|e| − f̂²/(2 K_pm); plus the energy stored in the
/// walls of an exercise.
/// h = ½ δ |f − f⁻|: energy hidden by an encoder of step δ. By partial summation f Δq_m differs
/// from the work done by at most δ/2 per unit change of f. A limit cycle of speed δ/(2T) reaches
/// that bound.
/// b v² kT: energy dissipated by the device's own damping; v is the velocity after a low-pass of
/// 2 ms. A low-pass of unit gain never adds energy, so this never exceeds the true dissipation.
///
/// A tank below 0 damps: f_t = −min(debt/(v² kT), α̂) v. The dissipated energy refills it. Where
/// damping is not enough and H falls to −Ĥ, the safety chain stops (kWorldGivesEnergy).

/// Longest output delay, in whole samples.
inline constexpr int kMostDelayTicks = 8;

/// Energy of avatar and world.
struct WorldEnergy {
  double held_j = 0.0;      ///< K
  double received_j = 0.0;  ///< W
};

struct EnergyTankConfig {
  int axes = 0;
  int delay_ticks = 0;
  AxisEnergy capacity;         ///< Ê [J]
  double hand_capacity = 0.0;  ///< Ĥ [J]
  AxisDamping device_damping;  ///< b
  AxisPosition encoder_step;   ///< δ
  AxisDamping most_damping;  ///< α̂: more damping would ring, or single encoder counts would be felt
};

/// Resolves the tanks of a device. Ê = f̂ d/2 with d = 5 mm at the tip, or 0.05 rad for an axis
/// without a tip: the energy of a spring that is pressed over d up to the limit f̂. A wall that
/// fades in under a finger draws on this energy. α̂ = 0.4 m/((1 + n) T + 2 ms), and at most such
/// that one encoder count causes 2 % of f̂. Ĥ is the sum of Ê.
[[nodiscard]] EnergyTankConfig makeEnergyTank(const DeviceModel& device, double period_s);

struct EnergyTankState {
  AxisEnergy energy;  ///< E
  double hand = 0.0;  ///< H [J]
  AxisEnergy stored;  ///< S
  AxisPosition q_m, q_s;
  AxisVelocity velocity;  ///< v
  AxisEffort avatar;      ///< a since the last tick
  /// Efforts sent, without the device's weight; ring buffer.
  std::array<AxisEffort, kMostDelayTicks + 2> sent{};
  /// The part of `sent` by which an exercise pushes.
  std::array<AxisEffort, kMostDelayTicks + 2> pushed{};
  int newest = 0;
  bool fresh = true;  ///< no previous tick
};

/// Makes full tanks: used at the start, after a pause, and while an effort is blended in. Real-time
/// safe.
[[nodiscard]] WHOLEHAND_RT EnergyTankState fullTank(const EnergyTankConfig& config) noexcept;

struct EnergyTankStep {
  EnergyTankState state;
  /// Damping effort of an empty tank, to be added to the rendered effort; 0 otherwise.
  AxisEffort effort;
};

/// Advances the tanks by one tick, before the effort is limited. Pure, real-time safe.
/// @param effort_limit f̂, in force now
/// @param wall_stored energy stored in the walls of an exercise, α k p²/2 per axis [J]; size 0:
/// none
[[nodiscard]] WHOLEHAND_RT EnergyTankStep
advanceTank(const EnergyTankState& state, const AxisPosition& q_m, const AxisPosition& q_s,
            const AxisEnergy& wall_stored, const WorldEnergy& world, const CouplingGains& gains,
            const EnergyTankConfig& config, const AxisEffort& effort_limit, int elapsed_periods,
            double period_s) noexcept;

/// Records the effort that was sent and the effort on the avatar. Call once a tick, after
/// advanceTank().
/// @param sent without the device's own weight
/// @param avatar_effort f_s, Eq. (2) @param effort_limit f̂, in force now
/// @param pushed the part of `sent` by which an exercise pushes, walls excluded; size 0: none
[[nodiscard]] WHOLEHAND_RT EnergyTankState recordSent(const EnergyTankState& state,
                                                      const AxisEffort& sent,
                                                      const AxisEffort& avatar_effort,
                                                      const AxisEffort& effort_limit,
                                                      const AxisEffort& pushed = {}) noexcept;

}  // namespace wholehand
