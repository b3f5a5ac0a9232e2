#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "dynamics/articulated_body.hpp"
#include "model/hand_model.hpp"

#include <Eigen/Core>

#include <vector>

namespace wholehand {

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
  [[nodiscard]] WHOLEHAND_RT bool isPalmar(const Contact& contact) const noexcept;

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

/// What of the contacts on a body is a grip [N]: normal forces of palmar contacts that oppose each
/// other. Their sum, at most kWeakerSide times what the weaker of two opposite sides bears.
[[nodiscard]] WHOLEHAND_RT double gripForce_n(const TickRecord& record, int body,
                                              const HandPosture& posture) noexcept;

}  // namespace wholehand
