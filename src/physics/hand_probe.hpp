#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "core/world_query.hpp"
#include "model/hand/hand_model.hpp"
#include "model/scene/scene_model.hpp"
#include "physics/axis_closure.hpp"
#include "physics/palm_distance.hpp"

namespace wholehand {

/// Geometry between hand and bodies for exercises, computed from joints and bodies as any engine
/// gives them. Owned by the renderer.
class HandProbe {
 public:
  HandProbe(const HandModel& hand, const SceneModel& scene);

  /// Clears the first touches found. Real-time safe.
  WHOLEHAND_RT void reset() noexcept { axis_closure_.reset(); }

  /// One tick: fills palm_distance_m, palm_body, palm_target_distance_m and closure from the
  /// record's theta, q_s and bodies. Real-time safe.
  /// @param links poses of the hand's links at theta, in the hand's order
  WHOLEHAND_RT void look(const Pose* links, const WorldQuery& query, TickRecord& record) noexcept;

  /// As look(), when joints or bodies are invalid: sets "nothing near" and "no touch known".
  /// Real-time safe.
  WHOLEHAND_RT void clearMeasurements(TickRecord& record) const noexcept;

 private:
  int palm_link_, axis_count_;
  PalmDistance palm_distance_;
  AxisClosure axis_closure_;
};

}  // namespace wholehand
