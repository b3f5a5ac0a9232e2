#include "physics/hand_probe.hpp"

#include <limits>

namespace wholehand {

HandProbe::HandProbe(const HandModel& hand, const SceneModel& scene)
    : palm_link_(hand.palm_link),
      axis_count_(hand.axis_count),
      palm_distance_(hand, scene),
      axis_closure_(hand, scene) {}

void HandProbe::look(const Pose* links, const WorldQuery& query, TickRecord& record) noexcept {
  const PalmDistance::Result palm =
      palm_distance_(links[palm_link_], record.bodies.data(), query.targets);
  record.palm_distance_m = palm.any_m;
  record.palm_body = palm.target;
  record.palm_target_distance_m = palm.target_m;
  axis_closure_.update(links, record.theta, record.q_s, query.closure_body, record.bodies.data(),
                       record.closure);
}

void HandProbe::clearMeasurements(TickRecord& record) const noexcept {
  record.palm_distance_m = record.palm_target_distance_m = std::numeric_limits<double>::infinity();
  record.palm_body = -1;
  record.closure = AxisPosition(axis_count_, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace wholehand
