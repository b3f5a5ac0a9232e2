#pragma once

#include "core/axis_array.hpp"
#include "dynamics/articulated_body.hpp"
#include "model/device_model.hpp"
#include "model/hand/hand_model.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

/// What the hand could touch within a time, from where it is.
///
/// Every axis moves at its speed limit, above which rendering stops, and at most to the end of its
/// range. A capsule's end then gets as far as the norm over the translations, and to first order
/// |∂p/∂q_a| |Δq_a| further for each rotation. Not real-time safe.
class HandReach {
 public:
  /// @pre both outlive this
  HandReach(const HandModel& hand, const DeviceModel& device, double within_s);

  /// Takes a posture of the hand.
  void look(const AxisPosition& q_s, const JointPosition& theta);

  struct Distance {
    double now_m = 0.0;  ///< between the hand's surface and the ball; negative: they overlap
    double missed_m =
        0.0;  ///< by which the hand misses the ball within the time; <= 0: it does not
  };
  /// Of a ball. One that the hand misses by more than `far_m` may have too small a distance.
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
  std::vector<Finger> capsules_;  ///< in the world
  Eigen::Vector3d middle_m_ = Eigen::Vector3d::Zero();
  double farthest_m_ = 0.0;  ///< from the middle, of all that the hand reaches
  double extent_m_ = 0.0;    ///< from the middle, of the hand
};

}  // namespace wholehand
