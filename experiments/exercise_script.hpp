#pragma once

#include "loop/core/expected.hpp"
#include "loop/patient/motion.hpp"
#include "rig/models.hpp"

#include <cstdint>
#include <string>

namespace wholehand {

/// Planned times of the parts of the paper's Fig. 7 [s].
namespace exercise_times {
/// The hand rests until then, while the glass slides into place.
inline constexpr double kServed = 1.0;
inline constexpr double kBeside = 1.8;  ///< left of the dispenser with stretched fingers
/// Deepest point of the bump with the back of the fingers.
inline constexpr double kHardBump = 2.15;
inline constexpr double kOffAgain = 2.5;
inline constexpr double kSoftBump = 3.6;
inline constexpr double kBumped = 4.1;  ///< the hand has moved away again
inline constexpr double kDrawnBack = 4.9;
inline constexpr double kAligned = 5.7;  ///< right of the dispenser and drawn back
inline constexpr double kEntered = 6.6;
inline constexpr double kPositioned = 7.3;  ///< the palm touches the dispenser
inline constexpr double kCloses = 8.8;      ///< the exercise's walls are faded in
inline constexpr double kSqueezes = 10.3;
inline constexpr double kLetsGo = 12.2;
inline constexpr double kOpened = 12.9;
inline constexpr double kRetrieves = 13.85;
inline constexpr double kOff = 14.55;
inline constexpr double kAway = 15.45;
inline constexpr double kEnd = 16.35;
}  // namespace exercise_times

/// The person's intended motion over time. The hand bumps into the dispenser twice with the back of
/// the fingers, draws back, approaches from the other side, lays the palm on, squeezes, releases,
/// and retracts while the fingers graze the dispenser. The seed shifts start and target by
/// millimetres.
/// @param home_m grip position at the dispenser (world)
[[nodiscard]] Intention exerciseIntention(const DeviceModel& device, const Eigen::Vector3d& home_m,
                                          std::uint64_t seed);

/// The motion of the paper's Fig. 6, which repeats approach from the side, grip, squeeze and
/// retreat.
[[nodiscard]] Intention squeezeAgainAndAgain(const DeviceModel& device,
                                             const Eigen::Vector3d& home_m, double duration_s);

}  // namespace wholehand
