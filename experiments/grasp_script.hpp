#pragma once

#include "experiments/grasp_trial.hpp"
#include "loop/patient/motion.hpp"
#include "rig/models.hpp"

#include <string>

namespace wholehand {

/// Planned times of a grasp [s].
namespace grasp_times {
inline constexpr double kApproached = 1.0, kOpposed = 1.6, kClosed = 2.8, kLiftBegins = 3.3,
                        kLifted = 4.8, kHoldBegins = 5.3;
}  // namespace grasp_times

inline constexpr double kLift_m = 0.2;

/// The person's intended motion over time in a trial.
[[nodiscard]] Intention graspIntention(const GraspTrial& trial, const Models& models);

/// Text of a scene file with the trial's object at the place where the hand closes; with gravity
/// the object stands on a pedestal.
[[nodiscard]] std::string graspScene(const GraspTrial& trial, const Models& models);

}  // namespace wholehand
