#pragma once

#include "core/real_time.hpp"
#include "exercise/kitchen/kitchen_task.hpp"

namespace wholehand::kitchen {

/// What the hand does to a thing: closes around it and carries it, pushes it with the tips of
/// straight fingers, or closes the fingers so that it comes towards the palm.
enum class Means { kGrasp, kPush, kSqueeze };
inline constexpr const char* kMeans[] = {"grasp", "push", "squeeze"};

/// How a hand without wrist meets the thing of a step.
struct Meeting {
  Means means = Means::kGrasp;
  Eigen::Vector3d toward = Eigen::Vector3d::UnitX();  ///< push: ±x, ±y or ±z of the world
  Eigen::Vector3d side_m = Eigen::Vector3d::Zero();   ///< from the grip to the point, body axes
  double sign = 1.0;                                  ///< of the change of q that is wanted
};

/// Derives it from the verbs up to the next let_go, the thing and its joint: what is to be taken is
/// grasped; else the direction in which the grip is to move decides. A hinge within radius_m of the
/// grip is a rocker, which is pushed away from the person beside the hinge. Real-time safe.
/// @param step index; the last one where it is beyond
/// @param q of the thing's joint
/// @param center_m of its mass, in the world
/// @param beside +1 where the palm faces +y (a right hand), -1 where it faces -y
[[nodiscard]] WHOLEHAND_RT Meeting meetingOf(const KitchenTask& task, int step, double q,
                                             const Eigen::Vector3d& center_m,
                                             double beside) noexcept;

}  // namespace wholehand::kitchen
