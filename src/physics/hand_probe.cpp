#include "physics/hand_probe.hpp"

#include "core/grid.hpp"

#include <limits>

namespace wholehand {
namespace {

/// Step of the distances and first touches [m or rad]: 0.06 µm. Finer digits are the noise of
/// arithmetic, and fill recordings.
constexpr double kStep = 0x1p-24;

}  // namespace

HandProbe::HandProbe(const HandModel& hand, const SceneModel& scene)
    : palm_link_(hand.palm_link),
      axis_count_(hand.axis_count),
      palm_distance_(hand, scene),
      axis_closure_(hand, scene) {}

void HandProbe::look(const Pose* links, const WorldQuery& query, TickRecord& record) noexcept {
  const PalmDistance::Result palm =
      palm_distance_(links[palm_link_], record.bodies.data(), query.targets);
  record.palm_distance_m = onGrid(palm.any_m, kStep);
  record.palm_body = palm.target;
  record.palm_target_distance_m = onGrid(palm.target_m, kStep);
  axis_closure_.update(links, record.theta, record.q_s, query.closure_body, record.bodies.data(),
                       record.closure);
  for (int i = 0; i < record.closure.size(); ++i) {
    record.closure[i] = onGrid(record.closure[i], kStep);
  }
}

void HandProbe::clearMeasurements(TickRecord& record) const noexcept {
  record.palm_distance_m = record.palm_target_distance_m = std::numeric_limits<double>::infinity();
  record.palm_body = -1;
  record.closure = AxisPosition(axis_count_, std::numeric_limits<double>::quiet_NaN());
}

}  // namespace wholehand
