#include "patient/habits.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kDrawBackShare = 0.2;   // of the slam's speed
constexpr double kNearEnd = 0.05;        // of the range
constexpr double kReachedShare = 0.998;  // of the slam's speed
constexpr double kDrawBackFor_s = 1.5, kPushFor_s = 1.0;

// The effort that brings the axis to a speed within a period if all else stays as it was.
double towardsSpeed(const SlamState& state, const SlamPlan& plan, double speed, double qd,
                    double period_s) noexcept {
  const double accelerated = (qd - state.qd) / period_s;
  const double wanted = (speed - qd) / period_s;
  return std::clamp(state.effort + plan.mass * (wanted - accelerated), -plan.effort, plan.effort);
}

bool drawnBack(const SlamState& state, const SlamPlan& plan, double q) noexcept {
  const double start = plan.sign > 0.0 ? plan.lower : plan.upper;
  return std::abs(q - start) <= kNearEnd * (plan.upper - plan.lower) ||
         state.since_s >= kDrawBackFor_s;
}

}  // namespace

double tremorEffort(double amplitude, double frequency_hz, double phase_rad,
                    double time_s) noexcept {
  return amplitude * std::sin(2.0 * std::numbers::pi * frequency_hz * time_s + phase_rad);
}

double openedTooFast(const StretchReflex& reflex, double qd_delayed) noexcept {
  return std::max(-qd_delayed - reflex.from_speed_rad_s, 0.0);
}

double reflexDriveFrom(const StretchReflex& reflex, double q, double too_fast) noexcept {
  return reflex.gain_nm_s_rad2 * too_fast * std::max(reflex.below_rad - q, 0.0);
}

double reflexDrive(const StretchReflex& reflex, double q, double qd_delayed) noexcept {
  return reflexDriveFrom(reflex, q, openedTooFast(reflex, qd_delayed));
}

double muscleEffort(double effort, double drive, double lag_s, double period_s) noexcept {
  return drive + (effort - drive) * std::exp(-period_s / lag_s);
}

double fightEffort(double most, double rendered, double qd, double still) noexcept {
  if (std::abs(qd) > still) return std::copysign(most, qd);
  return rendered > 0.0 ? -most : most;
}

SlamPlan planSlam(const Slam& slam, const DeviceAxis& axis) noexcept {
  SlamPlan plan;
  plan.sign = slam.towards_upper ? 1.0 : -1.0;
  plan.after_s = slam.after_s;
  plan.speed = slam.speed_share * axis.speed_limit;
  plan.effort = slam.effort_share * axis.effort_limit;
  plan.lower = axis.lower;
  plan.upper = axis.upper;
  plan.mass = axis.mass;
  return plan;
}

SlamState advanceSlam(SlamState state, const SlamPlan& plan, double q, double qd,
                      double period_s) noexcept {
  const auto enter = [&state](SlamPhase phase) {
    state.phase = phase;
    state.since_s = 0.0;
  };
  // Half a period of slack: sums of periods are not exact.
  if (state.phase == SlamPhase::kWaits && state.since_s >= plan.after_s - 0.5 * period_s) {
    enter(SlamPhase::kDrawsBack);
    state.qd = qd;
  }
  if (state.phase == SlamPhase::kDrawsBack && drawnBack(state, plan, q)) enter(SlamPhase::kPushes);
  if (state.phase == SlamPhase::kPushes &&
      (plan.sign * qd >= kReachedShare * plan.speed || state.since_s >= kPushFor_s)) {
    enter(SlamPhase::kLetGo);
  }
  const bool acts = state.phase == SlamPhase::kDrawsBack || state.phase == SlamPhase::kPushes;
  const double speed =
      plan.sign * plan.speed * (state.phase == SlamPhase::kPushes ? 1.0 : -kDrawBackShare);
  state.effort = acts ? towardsSpeed(state, plan, speed, qd, period_s) : 0.0;
  state.qd = qd;
  state.since_s += period_s;
  return state;
}

}  // namespace wholehand
