#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/hand_model.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// Computes what the hand could touch within a time from its current posture.
///
/// Every axis may move at its speed limit, above which rendering stops, and at most to the end of
/// its range. The end of a capsule then moves by at most the norm over the translations plus, to
/// first order, |∂p/∂q_a| |Δq_a| for each rotation. Not real-time safe.
class HandReach {
 public:
  /// @pre both outlive this
  HandReach(const HandModel& hand, const DeviceModel& device, double within_s);

  /// Sets the current posture of the hand.
  void look(const AxisPosition& q_s, const JointPosition& theta);

  struct Distance {
    /// Current distance between the hand's surface and the ball; negative: overlap.
    double now_m = 0.0;
    /// Distance by which the hand misses the ball within the time; <= 0: it reaches it.
    double missed_m = 0.0;
  };
  /// Distances to a ball. If the hand misses the ball by more than `far_m`, the results may be too
  /// small.
  [[nodiscard]] Distance to(const Eigen::Vector3d& centre_m, double radius_m, double far_m) const;

 private:
  struct Finger {
    Eigen::Vector3d a_m, b_m;
    double radius_m = 0.0, travel_m = 0.0;
  };
  [[nodiscard]] double travelOf(int link, const Eigen::Vector3d& point_m,
                                const AxisPosition& change) const;

  const HandModel& hand_;
  const DeviceModel& device_;
  const double within_s_;
  ArticulatedBody body_;
  std::vector<Finger> capsules_;  ///< capsules in the world
  Eigen::Vector3d middle_m_ = Eigen::Vector3d::Zero();
  double farthest_m_ = 0.0;  ///< largest distance from the middle that the hand reaches
  double extent_m_ = 0.0;    ///< largest distance of the hand's surface from the middle
};

}  // namespace wholehand
