#pragma once

#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/exercise/finger_walls.hpp"
#include "loop/model/hand_model.hpp"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace wholehand {

/// Contact of the links that one axis moves with the soft shell of a body.
struct SoftTouch {
  bool presses = false;         ///< closing presses one of its capsules deeper
  double palmar_depth_m = 0.0;  ///< depth of its deepest palmar capsule; 0: none
  /// Normal at that capsule, from the body to the hand.
  Eigen::Vector3d palmar_normal = Eigen::Vector3d::Zero();
};
using SoftTouches = std::array<SoftTouch, kMaxAxes>;

/// The hand in its posture of the present tick: clearance of its capsules, and the side of a
/// contact.
class HandPosture {
 public:
  explicit HandPosture(const HandModel& hand);

  /// Sets the hand in its present posture, which outlives the tick; null: unknown. Real-time safe.
  /// @pre it belongs to the hand that was given to the constructor
  WHOLEHAND_RT void update(const ArticulatedBody* hand) noexcept { posed_ = hand; }

  /// True for a contact on the palmar side: the palm itself, the flexor side of the fingers, the
  /// pad of the thumb. False for an unknown posture.
  /// @param normal unit, from the touched body to the hand
  [[nodiscard]] WHOLEHAND_RT bool isPalmar(int capsule,
                                           const Eigen::Vector3d& normal) const noexcept;

  /// Efforts by which a force on a capsule, at a point of it, opposes closing of every axis: -Jᵀf,
  /// with J the reduced point Jacobian [N or N·m]. World frame. 0 for an unknown posture.
  [[nodiscard]] WHOLEHAND_RT AxisEffort opposingEffort(
      int capsule, const Eigen::Vector3d& point_m, const Eigen::Vector3d& force_n) const noexcept;

  /// Finds for every axis its contact with the side of an upright cylindrical shell into which
  /// closing presses it.
  [[nodiscard]] WHOLEHAND_RT SoftTouches softTouches(const BodyState& body, double radius_m,
                                                     double height_m) const noexcept;

  /// The axes that move a link in contact with a body, as in FingerWallInput::touching.
  [[nodiscard]] WHOLEHAND_RT std::uint32_t touchingAxes(const TickRecord& record,
                                                        int body) const noexcept;
  /// Those whose links press on it with their palmar side.
  [[nodiscard]] WHOLEHAND_RT std::uint32_t palmarAxes(const TickRecord& record,
                                                      int body) const noexcept;

  /// Smallest distance of any capsule from an upright cylinder with rounded rims; never more than
  /// the true one [m]. 0 for an unknown posture.
  [[nodiscard]] WHOLEHAND_RT double clearance_m(const Eigen::Vector3d& center_m, double radius_m,
                                                double height_m) const noexcept;

 private:
  HandModel hand_;
  /// Palmar direction of each capsule: unit vector in its link's frame.
  std::vector<Eigen::Vector3d> palmar_;
  /// For each capsule: bit a where axis a moves it relative to the palm.
  std::vector<std::uint32_t> axes_of_capsule_;
  const ArticulatedBody* posed_ = nullptr;
};

/// Grip force on a body [N]: the sum of the normal forces of palmar contacts, at most five times
/// the weaker of two opposing sides. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double gripForce_n(const TickRecord& record, int body,
                                              const HandPosture& posture) noexcept;

/// Loads that a body puts on the digits.
struct FeltBody {
  int body = -1;        ///< index in the scene
  AxisEffort wall;      ///< effort of this body's walls on every axis; size 0: none
  SoftTouches touches;  ///< touches of its soft shell
};

/// Squeeze of a body: the force that the person feels from it at the fingertips [N].
///
///   S = min( Σ_a min(w_a + c_a, f_max,a) / l_a ,  5 · weaker side )
///
/// The sum runs over the axes with a wall. w_a is the wall's effort if the axis has a palmar touch
/// in the soft shell, c_a = -j_aᵀ f of the palmar contacts on the body, f_max,a the device's limit,
/// l_a the lever arm. The sides are those of gripForce_n; a digit in the soft shell counts with w_a
/// / l_a along its normal. The palm adds no squeeze, because the digits press against it. Real-time
/// safe.
[[nodiscard]] WHOLEHAND_RT double feltSqueeze_n(const TickRecord& record, const FeltBody& felt,
                                                const HandPosture& posture,
                                                const FingerWallConfig& walls,
                                                const AxisEffort& effort_limit) noexcept;

}  // namespace wholehand
