#pragma once

#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/core/world_query.hpp"
#include "loop/model/hand_model.hpp"
#include "loop/model/scene_model.hpp"
#include "loop/physics/axis_closure.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// Distance from the palm to the nearest body. It replaces the paper's invisible palm body without
/// collisions. The palm is the capsule named "hollow". It faces along its normal, away from the
/// back of the hand. A target is in front of the palm when the direction to its nearest point is
/// within 75 degrees of that normal. For all engines.
class PalmDistance {
 public:
  PalmDistance(const HandModel& hand, const SceneModel& scene);

  struct Result {
    double any_m;     ///< distance to the nearest body; +inf without bodies
    int target = -1;  ///< nearest target in any direction; -1: none
    double target_m;  ///< distance to that target: at least 0 in front of the palm, negative
                      ///< elsewhere; +inf without targets
  };

  /// @param palm pose of the palm's link @param bodies states in the scene's order
  /// @param targets bodies that are targets
  /// @return distances [m]; any_m is negative when palm and body overlap. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT Result operator()(const Pose& palm, const BodyState* bodies,
                                               const BodySet& targets = {}) const noexcept;

 private:
  Capsule palm_;
  std::vector<SceneBody> bodies_;
  std::vector<double> bounding_radius_m_;  ///< about the body's centre of mass
};

/// Measures the geometry between hand and bodies for exercises, from the joints and bodies that any
/// engine gives. Owned by the renderer.
class HandProbe {
 public:
  HandProbe(const HandModel& hand, const SceneModel& scene);

  /// Clears the first touches found. Real-time safe.
  WHOLEHAND_RT void reset() noexcept { axis_closure_.reset(); }

  /// Measures once per tick: fills palm_distance_m, palm_body, palm_target_distance_m and closure
  /// from the record's theta, q_s and bodies. Real-time safe.
  /// @param links poses of the hand's links at theta, in the hand's order
  WHOLEHAND_RT void look(const Pose* links, const WorldQuery& query, TickRecord& record) noexcept;

  /// Replaces look() when joints or bodies are invalid: sets "nothing near" and "no touch known".
  /// Real-time safe.
  WHOLEHAND_RT void clearMeasurements(TickRecord& record) const noexcept;

 private:
  int palm_link_, axis_count_;
  PalmDistance palm_distance_;
  AxisClosure axis_closure_;
};

}  // namespace wholehand
