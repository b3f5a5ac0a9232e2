#pragma once

#include "core/real_time.hpp"
#include "model/patient/patient_config.hpp"

// Active behaviour of a person on one axis. Pure laws: state in, state out. Real-time safe.
namespace wholehand {

/// A sin(2π f t + phase) [N or N·m].
[[nodiscard]] WHOLEHAND_RT double tremorEffort(double amplitude, double frequency_hz,
                                               double phase_rad, double time_s) noexcept;

/// (v - v_th)₊ with v = -q̇ delayed [rad/s].
[[nodiscard]] WHOLEHAND_RT double openedTooFast(const StretchReflex& reflex,
                                                double qd_delayed) noexcept;

/// g (v - v_th)₊ (s - s_th)₊, with v - v_th possibly of another axis. [N·m]
[[nodiscard]] WHOLEHAND_RT double reflexDriveFrom(const StretchReflex& reflex, double q,
                                                  double too_fast) noexcept;

/// Drive of the reflex to the muscle: g (v - v_th)₊ (s - s_th)₊ >= 0, in the direction of flexion.
/// Stretch is opening: v = -q̇ delayed and s - s_th = below - q. [N·m]
[[nodiscard]] WHOLEHAND_RT double reflexDrive(const StretchReflex& reflex, double q,
                                              double qd_delayed) noexcept;

/// First-order response to the drive, exact for a drive constant over the period. @pre lag_s > 0
[[nodiscard]] WHOLEHAND_RT double muscleEffort(double effort, double drive, double lag_s,
                                               double period_s) noexcept;

/// Full effort `most` along the motion, so that it always injects energy. Slower than `still`:
/// against the rendered effort; upwards without one. [N or N·m]
[[nodiscard]] WHOLEHAND_RT double fightEffort(double most, double rendered, double qd,
                                              double still) noexcept;

/// A slam within the limits of this device.
struct SlamPlan {
  double sign = 1.0;                ///< sign of the direction
  double after_s = 0.0;             ///< start time of drawing back
  double speed = 1.0;               ///< target speed [m/s or rad/s], > 0
  double effort = 1.0;              ///< largest effort [N or N·m], > 0
  double lower = 0.0, upper = 0.0;  ///< range [m or rad]
  double mass = 1.0;                ///< of the bare axis [kg or kg·m²], > 0
};
[[nodiscard]] SlamPlan planSlam(const Slam& slam, const DeviceAxis& axis) noexcept;

enum class SlamPhase { kWaits, kDrawsBack, kPushes, kLetGo };
struct SlamState {
  SlamPhase phase = SlamPhase::kWaits;
  double since_s = 0.0;  ///< time in this phase
  double effort = 0.0;   ///< effort over the next period [N or N·m]
  double qd = 0.0;       ///< velocity one period ago [m/s or rad/s]
};
/// One period of a slam. The effort targets the wanted speed one period later, assuming the
/// resistance of the last period. Draws back at a fifth of the speed, to the other end of the range
/// or for 1.5 s; pushes until the speed is reached, at most for 1 s; then lets go.
[[nodiscard]] WHOLEHAND_RT SlamState advanceSlam(SlamState state, const SlamPlan& plan, double q,
                                                 double qd, double period_s) noexcept;

}  // namespace wholehand
