#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "model/hand/hand_model.hpp"

#include <array>
#include <vector>

namespace wholehand {

/// A capsule of the hand and the joints between it and the parts that an axis does not move. Gives
/// the capsule's pose at any position of that axis without moving the hand.
class ClosingChain {
 public:
  /// @pre the axis moves the capsule
  ClosingChain(const HandModel& hand, int axis, int capsule);

  /// A capsule's segment, and the velocity of its points per unit of the axis.
  struct Placed {
    Eigen::Vector3d a_m, b_m;
    int joints = 0;
    std::array<Eigen::Vector3d, kMaxJoints> origin_m, screw;  ///< of the joints that the axis moves

    /// Velocity of a point of the capsule per unit of the axis [m/rad or m/m].
    [[nodiscard]] Eigen::Vector3d rate(const ClosingChain& chain,
                                       const Eigen::Vector3d& at_m) const;
  };

  /// @param root the root link's pose, in the desired frame @param theta, q current positions
  /// @param q_axis hypothetical position of the axis. Real-time safe.
  WHOLEHAND_RT void place(const Pose& root, const JointPosition& theta, double q_present,
                          double q_axis, Placed& placed) const noexcept;

  [[nodiscard]] int rootLink() const noexcept { return root_link_; }  ///< -1: the world
  [[nodiscard]] int capsule() const noexcept { return capsule_; }
  [[nodiscard]] double radius_m() const noexcept { return radius_m_; }
  /// Upper bound of the speed of the segment's points [m per unit of the axis].
  [[nodiscard]] double fastest() const noexcept { return fastest_; }
  /// Upper bound of their acceleration [m per unit of the axis squared].
  [[nodiscard]] double maxAcceleration() const noexcept { return sharpest_; }

  /// The capsules that each axis moves; none for an axis that carries the palm.
  [[nodiscard]] static std::vector<std::vector<ClosingChain>> ofAxes(const HandModel& hand);

 private:
  struct Joint {
    Pose from_previous;   ///< at joint position zero
    bool turned = false;  ///< from_previous has a rotation
    Eigen::Vector3d axis;
    bool revolute = true;
    int joint = -1;
    double ratio = 0.0;  ///< joint position per unit of the axis
  };

  void boundMotion(double travel) noexcept;

  std::vector<Joint> joints_;
  Eigen::Vector3d a_m_, b_m_;  ///< in the last joint's frame
  double radius_m_;
  double fastest_ = 0.0, sharpest_ = 0.0;
  int root_link_ = -1;
  int capsule_;
};

}  // namespace wholehand
