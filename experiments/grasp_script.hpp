#pragma once

#include "assembly/models.hpp"
#include "experiments/grasp_trial.hpp"
#include "patient/motion.hpp"

#include <string>

namespace wholehand {

/// When the parts of a grasp happen [s].
namespace grasp_times {
inline constexpr double kApproached = 1.0;
inline constexpr double kOpposed = 1.6;
inline constexpr double kClosed = 2.8;
inline constexpr double kLiftBegins = 3.3;
inline constexpr double kLifted = 4.8;
inline constexpr double kHoldBegins = 5.3;
}  // namespace grasp_times

inline constexpr double kLift_m = 0.2;

/// Where the hand's base is when it closes: low and forward, so that the lift fits the workspace.
[[nodiscard]] Eigen::Vector3d graspBase(const DeviceModel& device);

/// From where the hand comes, relative to that: along the palm's normal, thumb out of the way.
[[nodiscard]] Eigen::Vector3d graspApproach(const Models& models);
inline constexpr double kApproachCircumduction_rad = 0.09;

/// The person's aim over time for this trial.
[[nodiscard]] Intention graspIntention(const GraspTrial& trial, const Models& models);

/// Edge of the pedestal's top. Wider, and the little finger lands on it when it pinches.
inline constexpr double kPedestalWidth_m = 0.02;

/// A scene file with the trial's object where the hand will close, on a pedestal under gravity.
[[nodiscard]] std::string graspScene(const GraspTrial& trial, const Models& models,
                                     double pedestal_width_m = kPedestalWidth_m);

}  // namespace wholehand
