#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"

#include <Eigen/Core>

namespace wholehand {

/// Axes with which a virtual patient moves the hand, their ranges, and the position of an upright
/// cylinder held in a power grasp.
struct PlayerReach {
  int axes = 0;
  AxisPosition lower, upper;  ///< range of the device [m or rad]
  int x = -1, y = -1, z = -1, fingers = -1, turn = -1, thumb = -1;  ///< axis indices; -1: none
  Eigen::Vector3d grip_m = Eigen::Vector3d::Zero();  ///< from the hand's base to the centre of a
                                                     ///< held object
  double scale = 1.0;   ///< length of the hand over that of the adult median hand
  double beside = 1.0;  ///< +1 where the palm faces +y (a right hand), -1 where it faces -y
};

/// @param hand null: the adult median right hand
/// @param radius_m radius of the held object; 0 if the player adds the radius itself
[[nodiscard]] PlayerReach playerReach(const DeviceModel& device, const HandModel* hand,
                                      double radius_m);

/// World position of a point in a body's frame.
[[nodiscard]] WHOLEHAND_RT Eigen::Vector3d worldPoint(const BodyState& body,
                                                      const Eigen::Vector3d& point_m) noexcept;

}  // namespace wholehand
