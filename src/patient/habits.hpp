#pragma once

#include "core/real_time.hpp"
#include "model/patient_config.hpp"

// What a person does of their own accord, one axis at a time. Pure laws: state in, state out.
// Real-time safe.
namespace wholehand {

/// A sin(2π f t + phase) [N or N·m].
[[nodiscard]] WHOLEHAND_RT double tremorEffort(double amplitude, double frequency_hz,
                                               double phase_rad, double time_s) noexcept;

/// (v - v_th)₊, v = -q̇ of a delay ago [rad/s].
[[nodiscard]] WHOLEHAND_RT double openedTooFast(const StretchReflex& reflex,
                                                double qd_delayed) noexcept;

/// g (v - v_th)₊ (s - s_th)₊, where v - v_th may be another axis's. [N·m]
[[nodiscard]] WHOLEHAND_RT double drivenBy(const StretchReflex& reflex, double q,
                                           double too_fast) noexcept;

/// What the reflex asks of the muscle: g (v - v_th)₊ (s - s_th)₊ >= 0, in the direction of flexion;
/// stretch is opening, v = -q̇ of a delay ago and s - s_th = below - q. [N·m]
[[nodiscard]] WHOLEHAND_RT double reflexDrive(const StretchReflex& reflex, double q,
                                              double qd_delayed) noexcept;

/// First order towards the drive, exact for one that is held over the period. @pre lag_s > 0
[[nodiscard]] WHOLEHAND_RT double muscleEffort(double effort, double drive, double lag_s,
                                               double period_s) noexcept;

/// All of `most` with the motion, so that it always puts in energy; where it is slower than
/// `still`, against what is rendered, and where nothing is, upwards. [N or N·m]
[[nodiscard]] WHOLEHAND_RT double fightEffort(double most, double rendered, double qd,
                                              double still) noexcept;

/// A slam as this device can do it.
struct SlamPlan {
  double sign = 1.0;                ///< of the direction
  double after_s = 0.0;             ///< when drawing back begins
  double speed = 1.0;               ///< to be reached [m/s or rad/s], > 0
  double effort = 1.0;              ///< the most pushed [N or N·m], > 0
  double lower = 0.0, upper = 0.0;  ///< range [m or rad]
  double mass = 1.0;                ///< of the bare axis [kg or kg·m²], > 0
};
[[nodiscard]] SlamPlan planSlam(const Slam& slam, const DeviceAxis& axis) noexcept;

enum class SlamPhase { kWaits, kDrawsBack, kPushes, kLetGo };
struct SlamState {
  SlamPhase phase = SlamPhase::kWaits;
  double since_s = 0.0;  ///< in this phase
  double effort = 0.0;   ///< over the next period [N or N·m]
  double qd = 0.0;       ///< a period ago [m/s or rad/s]
};
/// One period of a slam. The effort aims at the wanted speed a period later, against a resistance
/// that is as large as in the last period. Draws back at a fifth of the speed, to the other end of
/// the range or for 1.5 s; pushes until the speed is reached, at most for 1 s; then lets go.
[[nodiscard]] WHOLEHAND_RT SlamState advanceSlam(SlamState state, const SlamPlan& plan, double q,
                                                 double qd, double period_s) noexcept;

}  // namespace wholehand
