#pragma once

#include "loop/core/geometry.hpp"
#include "loop/core/real_time.hpp"

#include <Eigen/Core>

#include <cstdint>

namespace wholehand {

/// Where a movement of an exercise goes, in the device's translations. Without a movement there is
/// no corridor.
struct MovementGoal {
  bool known = false;
  std::uint64_t movement = 0;  ///< another number is another movement
  Vec3 at_m;  ///< x, y, z of the device; an axis that the device lacks does not count
};

/// Resistance beside the straight way to a goal. It leads nobody:
///   f = −s min(K (|e| − r₀), f̂) e/|e|  where |e| > r₀, else 0,
/// e the offset of the hand from the segment that begins where the hand was when the movement
/// began. It is the slope of a function of the hand's place, so it returns no more work than it
/// received. Only one corridor acts. When its movement ends or its goal changes, s falls to 0 in
/// kFall_s over the old segment; then the goal of that moment gets its corridor, from where the
/// hand is.
struct CorridorConfig {
  double radius_m = 0.0;       ///< r₀
  double stiffness_n_m = 0.0;  ///< K
  double most_n = 0.0;         ///< f̂
  static constexpr double kFall_s = 0.3;
};

struct CorridorState {
  double scale = 0.0;  ///< s; 0: no corridor
  bool falls = false;
  MovementGoal goal;
  Eigen::Vector3d from_m = Eigen::Vector3d::Zero();
};

/// Advances the corridor by a tick. Pure, real-time safe.
/// @param allowed false: no corridor begins, and the present one falls
[[nodiscard]] WHOLEHAND_RT CorridorState advanceCorridor(const CorridorState& state,
                                                         const CorridorConfig& config,
                                                         const Eigen::Vector3d& hand_m,
                                                         const MovementGoal& goal, bool allowed,
                                                         double elapsed_s) noexcept;

struct CorridorPush {
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();  ///< e/|e|; 0 without a force
  double stored_j = 0.0;
};
[[nodiscard]] WHOLEHAND_RT CorridorPush pushOfCorridor(const CorridorState& state,
                                                       const CorridorConfig& config,
                                                       const Eigen::Vector3d& hand_m) noexcept;

}  // namespace wholehand
