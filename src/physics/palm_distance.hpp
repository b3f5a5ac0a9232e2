#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// Distance from the palm to the nearest body: the paper's invisible palm body without collisions.
/// The palm is the capsule in its hollow ("hollow"). It looks along its normal, away from the back
/// of the hand: a target is before the palm where the way to its nearest point goes that way,
/// within 75 degrees. Serves every engine.
class PalmDistance {
 public:
  PalmDistance(const HandModel& hand, const SceneModel& scene);

  struct Result {
    double any_m;     ///< to the nearest body; +inf without bodies
    int target = -1;  ///< the nearest target on any side; -1: none
    double target_m;  ///< to that: at least 0 before the palm, negative elsewhere; +inf without
  };

  /// @param palm pose of the palm's link @param bodies states in the scene's order
  /// @param targets bit b: body b is a target
  /// @return [m]; any_m is negative where they overlap. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Result operator()(const Pose& palm, const BodyState* bodies,
                                               std::uint32_t targets = 0) const noexcept;

 private:
  Capsule palm_;
  std::vector<SceneBody> bodies_;
  std::vector<double> bounding_radius_m_;  ///< about the body's centre of mass
};

}  // namespace wholehand
