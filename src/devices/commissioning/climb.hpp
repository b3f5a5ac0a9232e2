#pragma once

#include "devices/commissioning/bench.hpp"

#include <array>
#include <cstddef>
#include <vector>

/// The climb from a fifth of the effort limit to the limit in force, one fifth at a time.
namespace wholehand {

/// Shares of the effort limit to which the climb pushes, in this order. A push is as slow as the
/// speed limit needs.
inline constexpr std::array<double, 5> kClimbShares = {0.2, 0.4, 0.6, 0.8, 1.0};

/// Response of an axis to one push, compared with the motion that its figures predict.
struct PushResponse {
  double gain = 0.0;   ///< measured over predicted displacement, least squares
  double apart = 0.0;  ///< rms of what differs beyond the gain, relative to the prediction
};

/// Figures that an axis must confirm.
struct ClimbedAxis {
  double mass = 0.0, damping = 0.0, coulomb = 0.0;
  double delay_s = 0.0;
};

/// Length of a push that is gentle enough for the axis: at the limit it reaches 0.4 of the speed
/// limit or a tenth of the range, but its effort may rise no faster than the slew limit.
[[nodiscard]] double pushLength_s(const DeviceAxis& axis, double mass);

/// Push of one axis, in units of its peak, at u = time / length in 0 .. 1: -1/2 (cos 2πu - cos
/// 4πu). It begins and ends at 0 and leaves a free mass where it was, at rest.
[[nodiscard]] double pushShape(double u);

/// Climbs with one axis, up and down at every share, while soft springs hold the others. Ends at
/// the first push whose response disagrees: gain off by more than three tenths, a shape that
/// differs by a quarter, or another axis that moves along by more than a fifth. Returns the share
/// reached.
[[nodiscard]] Expected<double> climb(Bench& bench, std::size_t axis, const ClimbedAxis& measured,
                                     const std::vector<double>& offset);

/// Compares positions with the prediction for the efforts sent; pure. The effort k was sent after
/// the position k was read.
/// @param effort without what carries the axis [N or N·m]
[[nodiscard]] PushResponse comparePush(const std::vector<double>& position,
                                       const std::vector<double>& effort, double period_s,
                                       const ClimbedAxis& measured);

}  // namespace wholehand
