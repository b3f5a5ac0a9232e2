#include "exercise/cocktail_bar/bar_view.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>

namespace wholehand {
namespace {

// Power grasp of an upright cylinder of 2.5 cm radius, hand in handshake: its axis from the base of
// the adult median hand, whose middle knuckle is kKnuckle_m from the base. Measured.
constexpr double kAhead_m = 0.049, kPalm_m = 0.016, kUp_m = 0.004;
constexpr double kKnuckle_m = 0.0661;

Vec3 vec3(const nlohmann::json& numbers) {
  return {numbers.at(0).get<double>(), numbers.at(1).get<double>(), numbers.at(2).get<double>()};
}

double handScale(const HandModel& hand) {
  for (const HandLink& link : hand.links) {
    if (link.name == "middle_mcp_flexion") {
      return link.parent_to_link.translation_m.norm() / kKnuckle_m;
    }
  }
  return 1.0;
}

void readDispensers(const ExerciseDescription& description, const SceneModel& scene, BarView& view,
                    double& radius_m) {
  const auto json = nlohmann::json::parse(description.json, nullptr, false);
  if (json.is_discarded() || !json.contains("dispensers")) return;
  for (const auto& item : json["dispensers"]) {
    if (view.dispenser_count == BarView::kMost) return;
    BarView::Dispenser dispenser;
    dispenser.body = scene.bodyIndex(item.value("body", ""));
    dispenser.free = item.value("free", false);
    if (item.contains("grip_m")) dispenser.grip_m = vec3(item["grip_m"]);
    if (item.contains("nozzle_m")) dispenser.nozzle_m = vec3(item["nozzle_m"]);
    radius_m = item.value("radius_m", radius_m);
    view.dispensers[static_cast<std::size_t>(view.dispenser_count++)] = dispenser;
  }
  if (!json.contains("glass")) return;
  view.glass_body = scene.bodyIndex(json["glass"].value("body", ""));
  view.glass_top_m = 0.5 * json["glass"].value("height_m", 0.0);
}

double valueAt(const ExerciseRecord& record, int index) {
  return index >= 0 && index < record.value_count ? record.values[static_cast<std::size_t>(index)]
                                                  : 0.0;
}

}  // namespace

BarView makeBarView(const ExerciseDescription& description, const DeviceModel& device,
                    const HandModel& hand, const SceneModel& scene) {
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
  double radius_m = 0.025;
  readDispensers(description, scene, view, radius_m);
  const double scale = handScale(hand);
  view.beside = hand.side == Side::kRight ? 1.0 : -1.0;
  view.grip_m = {scale * kAhead_m, view.beside * (scale * kPalm_m + radius_m), scale * kUp_m};
  const auto& names = description.value_names;
  const auto index = [&names](const char* name) {
    const auto found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? -1 : static_cast<int>(found - names.begin());
  };
  view.values = {index("stage"),
                 index("step"),
                 index("drink"),
                 index("target_dispenser"),
                 index("engaged_dispenser"),
                 index("squeeze_n"),
                 index("squeeze_low_n"),
                 index("squeeze_high_n"),
                 index("flow_l_s"),
                 index("over_glass"),
                 index("poured_l"),
                 index("asked_l"),
                 index("tolerance_l")};
  return view;
}

BarGlance glance(const BarView& view, const ExerciseRecord& record) noexcept {
  const BarView::Values& at = view.values;
  const auto number = [&](int index) { return valueAt(record, index); };
  const auto whole = [&](int index) { return static_cast<int>(valueAt(record, index)); };
  BarGlance out;
  out.stage = static_cast<BarStage>(std::clamp(whole(at.stage), 0, 6));
  out.drink = whole(at.drink);
  out.step = whole(at.step);
  out.target = at.target >= 0 ? whole(at.target) : -1;
  out.engaged = at.engaged >= 0 ? whole(at.engaged) : -1;
  out.squeeze_n = number(at.squeeze_n);
  out.low_n = number(at.low_n);
  out.high_n = number(at.high_n);
  out.flow_l_s = number(at.flow_l_s);
  out.poured_l = number(at.poured_l);
  out.asked_l = number(at.asked_l);
  out.tolerance_l = number(at.tolerance_l);
  out.over_glass = number(at.over_glass) > 0.5;
  return out;
}

Eigen::Vector3d worldPoint(const BodyState& body, const Vec3& point_m) noexcept {
  return body.position_m.eigen() + body.orientation_xyzw.eigen() * point_m.eigen();
}

}  // namespace wholehand
