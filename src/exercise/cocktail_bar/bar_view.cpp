#include "exercise/cocktail_bar/bar_view.hpp"

#include "exercise/cocktail_bar/bar_values.hpp"

#include <algorithm>

namespace wholehand {
namespace {

// Power grasp of an upright cylinder, hand in handshake: its axis from the base of the adult median
// hand, whose middle knuckle is kKnuckle_m from the base; beside the palm's half thickness comes
// the cylinder's radius. Measured.
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

BarView makeBarView(const Bar& bar, const DeviceModel& device, const HandModel* hand) {
  BarView view;
  view.axes = device.axisCount();
  view.lower = view.upper = AxisPosition(view.axes);
  for (int i = 0; i < view.axes; ++i) {
    view.lower[i] = device.axes[static_cast<std::size_t>(i)].lower;
    view.upper[i] = device.axes[static_cast<std::size_t>(i)].upper;
  }
  view.x = device.axisIndex("x");
  view.y = device.axisIndex("y");
  view.z = device.axisIndex("z");
  view.fingers = device.axisIndex("finger_flexion");
  view.turn = device.axisIndex("thumb_circumduction");
  view.thumb = device.axisIndex("thumb_flexion");
  double radius_m = 0.0;
  for (const BarDispenser& d : bar.dispensers) {
    if (view.dispenser_count == kMaxDispensers) break;
    view.dispensers[static_cast<std::size_t>(view.dispenser_count++)] = {d.body_index, d.grip_m,
                                                                         d.nozzle_m, d.free};
    radius_m = std::max(radius_m, d.radius_m);
  }
  const double scale = hand != nullptr ? handScale(*hand) : 1.0;
  view.beside = hand != nullptr && hand->side == Side::kLeft ? -1.0 : 1.0;
  view.grip_m = {scale * kAhead_m, view.beside * (scale * kPalm_m + radius_m), scale * kUp_m};
  view.glass_body = bar.glass.body_index;
  view.glass_top_m = 0.5 * bar.glass.height_m;
  return view;
}

BarReach reachOf(const BarView& view, double slack_m) noexcept {
  BarReach reach;
  const std::array<int, 3> axes = {view.x, view.y, view.z};
  for (int k = 0; k < 3; ++k) {
    const int axis = axes[static_cast<std::size_t>(k)];
    if (axis < 0) continue;
    reach.lower_m[k] = view.lower[axis] + view.grip_m[k] - slack_m;
    reach.upper_m[k] = view.upper[axis] + view.grip_m[k] + slack_m;
  }
  return reach;
}

BarGlance glance(const ExerciseRecord& record) noexcept {
  const auto number = [&record](BarValue value) noexcept {
    const auto i = static_cast<std::int32_t>(value);
    return i < record.value_count ? record.values[static_cast<std::size_t>(i)] : 0.0;
  };
  const auto whole = [&number](BarValue v) noexcept { return static_cast<int>(number(v)); };
  BarGlance out;
  if (record.value_count == 0) return out;
  out.stage = static_cast<BarStage>(whole(BarValue::kStage));
  out.drink = whole(BarValue::kDrink);
  out.step = whole(BarValue::kStep);
  out.target = whole(BarValue::kTargetDispenser);
  out.engaged = whole(BarValue::kEngagedDispenser);
  out.squeeze_n = number(BarValue::kSqueeze);
  out.low_n = number(BarValue::kSqueezeLow);
  out.high_n = number(BarValue::kSqueezeHigh);
  out.flow_l_s = number(BarValue::kFlow);
  out.poured_l = number(BarValue::kPoured);
  out.asked_l = number(BarValue::kAsked);
  return out;
}

Eigen::Vector3d worldPoint(const BodyState& body, const Eigen::Vector3d& point_m) noexcept {
  return body.position_m.eigen() + body.orientation_xyzw.eigen() * point_m;
}

}  // namespace wholehand
