#pragma once

#include "control/adaptive_damping.hpp"
#include "core/live_parameter.hpp"
#include "core/real_time.hpp"
#include "model/device_model.hpp"

#include <vector>

namespace wholehand {

/// The most parameters of LiveSettings.
inline constexpr int kMostLiveSettings = 4;

/// What a therapist may change of the rendering while it runs: less effort than the device's limit,
/// never more; when the adaptive damping sets in and how fast it fades. Gains stay as certified.
///
///   effort_limit_hand_tip_n  largest force at a fingertip; hand axes without a tip alike by ratio
///   effort_limit_arm_n       largest force on the arm; wrist rotations alike by ratio
///   damping_full_n           effort at which the damping is full (f₀, Algorithm 1) of the first
///                            axis that has one in N; all other axes alike by ratio, f_d too
///   damping_decay_s          τ of Algorithm 1, of every axis
///
/// A parameter that no axis of the device would follow is left out.
class LiveSettings {
 public:
  LiveSettings() = default;  ///< nothing may be changed
  LiveSettings(const DeviceModel& device, const AdaptiveDampingConfig& damping);

  [[nodiscard]] const std::vector<LiveParameter>& parameters() const noexcept {
    return parameters_;
  }

  /// Turns present values (in the order of parameters()) into limits and damping, from those at the
  /// start. Real-time safe.
  WHOLEHAND_RT void apply(const double* values, const AxisEffort& device_limit,
                          const AdaptiveDampingConfig& damping_at_start, AxisEffort& limit,
                          AdaptiveDampingConfig& damping) const noexcept;

 private:
  enum class Role { kHandLimit, kArmLimit, kDampingFull, kDampingDecay };
  void add(Role role, LiveParameter parameter);

  std::vector<LiveParameter> parameters_;
  std::vector<Role> roles_;
  AxisRatio hand_axis_;  ///< 1: moves the hand's joints
  AxisRatio in_unit_;    ///< limit = value · in_unit where > 0 ...
                         ///< ... else the device's limit · value / upper
};

}  // namespace wholehand
