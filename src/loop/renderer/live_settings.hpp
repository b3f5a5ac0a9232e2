#pragma once

#include "loop/control/adaptive_damping.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"

#include <array>
#include <vector>

namespace wholehand {

/// Live parameters that ramp towards their targets, each at most at its rate.
class ParameterRamps {
 public:
  /// @pre at most kMaxLiveParameters; rates > 0
  explicit ParameterRamps(const std::vector<LiveParameter>& parameters);

  /// Sets a parameter's value at reset() instead of its default. Ignores unknown indices, NaN and
  /// values out of range.
  void startAt(int index, double value) noexcept;
  /// Sets every parameter to its start value.
  void reset() noexcept;
  /// Sets a parameter's target. Ignores unknown indices, NaN and values out of range. Real-time
  /// safe.
  WHOLEHAND_RT void ask(int index, double value) noexcept;
  /// Sets a parameter's value and target at once, before any effort was sent. Ignores what ask()
  /// ignores. Real-time safe.
  WHOLEHAND_RT void set(int index, double value) noexcept;
  /// Advances the ramps by one tick. Real-time safe.
  WHOLEHAND_RT void advance(int elapsed_periods, double period_s) noexcept;

  [[nodiscard]] int count() const noexcept { return count_; }
  [[nodiscard]] const double* values() const noexcept { return value_.data(); }
  [[nodiscard]] const double* atStart() const noexcept { return initial_.data(); }

 private:
  using Values = std::array<double, kMaxLiveParameters>;
  int count_ = 0;
  Values lower_{}, upper_{}, rate_per_s_{}, initial_{}, value_{}, wanted_{};
};

/// Most parameters of LiveSettings.
inline constexpr int kMostLiveSettings = 4;

/// Rendering parameters that a therapist may change while the loop runs: effort limits below those
/// of the device, and onset and decay of the adaptive damping. The gains stay as certified.
///
///   effort_limit_hand_tip_n  largest force at a fingertip; hand axes without a tip scale by the
///   same ratio
///   effort_limit_arm_n       largest force on the arm; wrist rotations scale by the same ratio
///   damping_full_n           effort at which the damping is full (f₀, Algorithm 1) of the first
///                            axis that has one in N; all other axes scale by the same ratio, f_d
///                            too
///   damping_decay_s          τ of Algorithm 1, of every axis
///
/// A parameter that affects no axis of the device is left out.
class LiveSettings {
 public:
  LiveSettings() = default;  ///< no live parameters
  LiveSettings(const DeviceModel& device, const AdaptiveDampingConfig& damping);

  [[nodiscard]] const std::vector<LiveParameter>& parameters() const noexcept {
    return parameters_;
  }

  /// Computes limits and damping from the current values, given in the order of parameters(), and
  /// from the initial damping. Real-time safe.
  WHOLEHAND_RT void apply(const double* values, const AxisEffort& device_limit,
                          const AdaptiveDampingConfig& damping_at_start, AxisEffort& limit,
                          AdaptiveDampingConfig& damping) const noexcept;

 private:
  enum class Role { kHandLimit, kArmLimit, kDampingFull, kDampingDecay };
  void add(Role role, LiveParameter parameter);

  std::vector<LiveParameter> parameters_;
  std::vector<Role> roles_;
  AxisFlag hand_axis_;  ///< the axis moves the hand's joints
  AxisLength in_unit_;  ///< limit = value · in_unit where > 0 ...
                        ///< ... else the device's limit · value / upper
};

}  // namespace wholehand
