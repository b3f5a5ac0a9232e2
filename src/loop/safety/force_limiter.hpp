#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/fault.hpp"
#include "loop/core/real_time.hpp"

#include <array>

namespace wholehand {

/// A limited effort and the faults of the limits that acted.
struct LimitedEffort {
  AxisEffort effort;  ///< every element finite and within ± limit
  Fault faults = Fault::kNone;
  int axis = -1;  ///< first axis that was limited; -1: no particular axis
};

/// Clamps every effort to ± limit (Fault::kEffortLimit, information). NaN and infinity become 0 and
/// report Fault::kNonFiniteEffort, which stops rendering. A limit that is NaN or ≤ 0 gives 0. The
/// result has the size of `limit`; a missing effort is 0. Pure, real-time safe.
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitEffort(const AxisEffort& effort,
                                                     const AxisEffort& limit) noexcept;

/// Limits the power that all axes together deliver to `limit_w`. No axis may deliver more than p̂,
/// the largest power for which Σ min(pᵢ, p̂) does not exceed the limit. Efforts along the motion
/// are scaled down to p̂; braking efforts stay (Fault::kPowerLimit, information). The result is
/// continuous; an axis that hardly moves keeps its effort, whatever its velocity noise. The
/// device's own weight is not counted. The slew limit acts after this limit: when a hand
/// accelerates faster than the effort may fall, the power limit is met some ticks later. Pure,
/// real-time safe.
/// @param effort finite, as it would be sent @param neutral carries the device's weight
/// @param limit_w > 0
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitPower(const AxisEffort& effort,
                                                    const AxisEffort& neutral,
                                                    const AxisVelocity& qd,
                                                    double limit_w) noexcept;

/// Window of the slew limit. Within it neither a person nor a mechanism can distinguish a step from
/// a ramp. A fixed window also keeps the step of a damper at an impact equally high at every rate.
inline constexpr double kSlewWindow_s = 1e-3;
inline constexpr int kMostSlewTicks = 16;  ///< capacity of SlewWindow [periods]

/// Number of whole periods in kSlewWindow_s, 1 to kMostSlewTicks.
[[nodiscard]] int slewTicks(double period_s) noexcept;

/// The efforts sent in the last periods. Real-time safe.
class SlewWindow {
 public:
  /// @param ticks number of efforts to remember, 1 .. kMostSlewTicks
  explicit SlewWindow(int ticks = 1) noexcept : ticks_(ticks) {}

  WHOLEHAND_RT void clear() noexcept { count_ = 0; }
  WHOLEHAND_RT void note(const AxisEffort& sent) noexcept;

  [[nodiscard]] WHOLEHAND_RT double newest(int axis) const noexcept { return sent_[newest_][axis]; }
  [[nodiscard]] WHOLEHAND_RT double least(int axis) const noexcept;
  [[nodiscard]] WHOLEHAND_RT double most(int axis) const noexcept;

 private:
  int ticks_, count_ = 0, newest_ = 0;
  std::array<AxisEffort, kMostSlewTicks> sent_{};
};

/// Keeps every effort within most_change of all efforts sent in the window (Fault::kEffortSlew,
/// information). This is the last step before the device: no event, not even a longer stall, can
/// cause a sudden blow. Pure, real-time safe.
/// @param effort finite @param last not empty @param most_change largest change within the window,
/// > 0
[[nodiscard]] WHOLEHAND_RT LimitedEffort limitSlew(const AxisEffort& effort, const SlewWindow& last,
                                                   const AxisEffort& most_change) noexcept;

}  // namespace wholehand
