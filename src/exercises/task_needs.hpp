#pragma once

#include "exercises/player_reach.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/prescription.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace wholehand {

/// Part of a device's axis that a task uses [m or rad].
struct TaskNeed {
  int axis = -1;  ///< index into DeviceModel::axes
  double lower = 0.0, upper = 0.0;
};

/// What a task needs of the hand. A scene can be moved along the translations, so that they are
/// within a person's limits. Not real-time safe.
class TaskNeeds {
 public:
  /// Adds a position of the hand's base. Axes that the device lacks do not count.
  void addBase(const PlayerReach& reach, const Eigen::Vector3d& base_m);
  /// Adds a position along one axis; axis < 0: none.
  void add(int axis, double at);
  /// Adds fingers that open wider than an upright cylinder and close on it in a power grasp.
  /// @param radius_m radius of the held object
  void addGrasp(const PlayerReach& reach, const HandModel& hand, double radius_m);

  [[nodiscard]] const std::vector<TaskNeed>& all() const noexcept { return needs_; }

 private:
  std::vector<TaskNeed> needs_;
};

/// The device as a task may use it: each limit of the prescription without its walls.
[[nodiscard]] DeviceModel deviceWithin(const DeviceModel& device, const Prescription& prescription);

/// How far the scene must be moved for these needs [m]. Refused when an axis's range is narrower
/// than what is needed of it, or when a rotation is needed beyond it.
/// @param within the device as the task may use it
[[nodiscard]] Expected<Eigen::Vector3d> placeWithin(const TaskNeeds& needs,
                                                    const DeviceModel& within,
                                                    const std::string& exercise,
                                                    const Prescription& prescription);

}  // namespace wholehand
