#include "exercise/cocktail_bar/bar_layout.hpp"

#include <algorithm>

namespace wholehand {
namespace {

// Power grasp of an upright cylinder, hand in handshake orientation: the cylinder's axis from the
// base of the adult median hand, whose middle knuckle is kKnuckle_m from the base. The cylinder's
// radius adds to the palm's half thickness. Measured.
constexpr double kAhead_m = 0.049, kPalm_m = 0.016, kUp_m = 0.004;
constexpr double kKnuckle_m = 0.0661;

double handScale(const HandModel& hand) {
  for (const HandLink& link : hand.links) {
    if (link.name == "middle_mcp_flexion") {
      return link.parent_to_link.translation_m.norm() / kKnuckle_m;
    }
  }
  return 1.0;
}

}  // namespace

BarLayout makeBarLayout(const Bar& bar, const DeviceModel& device, const HandModel* hand) {
  BarLayout layout;
  layout.axes = device.axisCount();
  layout.lower = layout.upper = AxisPosition(layout.axes);
  for (int i = 0; i < layout.axes; ++i) {
    layout.lower[i] = device.axes[i].lower;
    layout.upper[i] = device.axes[i].upper;
  }
  layout.x = device.axisIndex("x");
  layout.y = device.axisIndex("y");
  layout.z = device.axisIndex("z");
  layout.fingers = device.axisIndex("finger_flexion");
  layout.turn = device.axisIndex("thumb_circumduction");
  layout.thumb = device.axisIndex("thumb_flexion");
  double radius_m = 0.0;
  for (const BarDispenser& d : bar.dispensers) {
    if (layout.dispenser_count == kMaxDispensers) break;
    layout.dispensers[layout.dispenser_count++] = {d.body_index, d.grip_m, d.nozzle_m, d.free};
    radius_m = std::max(radius_m, d.radius_m);
  }
  const double scale = hand != nullptr ? handScale(*hand) : 1.0;
  layout.beside = hand != nullptr && hand->side == Side::kLeft ? -1.0 : 1.0;
  layout.grip_m = {scale * kAhead_m, layout.beside * (scale * kPalm_m + radius_m), scale * kUp_m};
  layout.glass_body = bar.glass.body_index;
  layout.glass_top_m = 0.5 * bar.glass.height_m;
  return layout;
}

BarReach reachOf(const BarLayout& layout, double slack_m) noexcept {
  BarReach reach;
  const std::array<int, 3> axes = {layout.x, layout.y, layout.z};
  for (int k = 0; k < 3; ++k) {
    const int axis = axes[k];
    if (axis < 0) continue;
    reach.lower_m[k] = layout.lower[axis] + layout.grip_m[k] - slack_m;
    reach.upper_m[k] = layout.upper[axis] + layout.grip_m[k] + slack_m;
  }
  return reach;
}

Eigen::Vector3d worldPoint(const BodyState& body, const Eigen::Vector3d& point_m) noexcept {
  return body.position_m.eigen() + body.orientation_xyzw.eigen() * point_m;
}

}  // namespace wholehand
