#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "model/hand/hand_model.hpp"
#include "model/scene/scene_model.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// Distance from the palm to the nearest body: replaces the paper's invisible palm body without
/// collisions. The palm is the capsule in its hollow ("hollow"), and faces along its normal, away
/// from the back of the hand. A target is in front of the palm when the direction to its nearest
/// point is within 75 degrees of that normal. For all engines.
class PalmDistance {
 public:
  PalmDistance(const HandModel& hand, const SceneModel& scene);

  struct Result {
    double any_m;     ///< to the nearest body; +inf without bodies
    int target = -1;  ///< nearest target in any direction; -1: none
    double target_m;  ///< distance to it: at least 0 in front of the palm, negative elsewhere; +inf
                      ///< without targets
  };

  /// @param palm pose of the palm's link @param bodies states in the scene's order
  /// @param targets those that are
  /// @return [m]; any_m is negative where they overlap. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Result operator()(const Pose& palm, const BodyState* bodies,
                                               const BodySet& targets = {}) const noexcept;

 private:
  Capsule palm_;
  std::vector<SceneBody> bodies_;
  std::vector<double> bounding_radius_m_;  ///< about the body's centre of mass
};

}  // namespace wholehand
