#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "dynamics/articulated_body.hpp"
#include "model/hand_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace wholehand {

/// What an axis moves against the palm, in the soft side of a body.
struct SoftTouch {
  bool presses = false;         ///< closing presses something of it further in
  double palmar_depth_m = 0.0;  ///< of its palmar capsule that is deepest; 0: none
  Eigen::Vector3d palmar_normal = Eigen::Vector3d::Zero();  ///< there, from the body to the hand
};
using SoftTouches = std::array<SoftTouch, kMaxAxes>;

/// The hand as a tick shows it: where its capsules are, and which side of it a contact is on.
class HandPosture {
 public:
  explicit HandPosture(const HandModel& hand);
  HandPosture(const HandPosture&) = delete;
  HandPosture& operator=(const HandPosture&) = delete;

  /// Real-time safe. A posture of another size is unknown.
  WHOLEHAND_RT void update(const JointPosition& theta) noexcept;

  /// Whether a contact is on the side that faces the palm: the palm's own, the fingers' flexor
  /// side, the thumb's pad. False where the posture is unknown.
  /// @param normal unit, from what is touched to the hand
  [[nodiscard]] WHOLEHAND_RT bool isPalmar(int capsule,
                                           const Eigen::Vector3d& normal) const noexcept;

  /// How much a force on a capsule, at a point of it, holds an axis back from closing: -jᵀf with
  /// the axis's column j of the reduced point Jacobian [N or N·m]. World frame. 0 where the posture
  /// is unknown.
  [[nodiscard]] WHOLEHAND_RT double opposes(int axis, int capsule, const Eigen::Vector3d& point_m,
                                            const Eigen::Vector3d& force_n) const noexcept;

  /// Of every axis, what it moves that is inside an upright cylinder from the side, where closing
  /// presses it further in.
  [[nodiscard]] WHOLEHAND_RT SoftTouches
  softTouches(const BodyState& body, double radius_m, double height_m,
              const std::vector<std::uint32_t>& axes_of_capsule) const noexcept;

  /// Smallest distance of any capsule from an upright cylinder, its rims taken for round: never
  /// more than the true one. 0 where the posture is unknown. [m]
  [[nodiscard]] WHOLEHAND_RT double clearance_m(const Eigen::Vector3d& center_m, double radius_m,
                                                double height_m) const noexcept;

 private:
  HandModel hand_;
  std::vector<Eigen::Vector3d> palmar_;  ///< of each capsule: unit, in its link's frame
  ArticulatedBody body_;
  bool known_ = false;
};

}  // namespace wholehand
