#include "exercises/player_reach.hpp"

namespace wholehand {
namespace {

// Position of an upright cylinder's axis relative to the base of the adult median hand, in a power
// grasp with the hand in handshake orientation. The middle knuckle is kKnuckle_m from the base; the
// cylinder's radius adds to the palm's half thickness. Measured values.
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

PlayerReach playerReach(const DeviceModel& device, const HandModel* hand, double radius_m) {
  PlayerReach reach;
  reach.axes = device.axisCount();
  reach.lower = reach.upper = AxisPosition(reach.axes);
  for (int i = 0; i < reach.axes; ++i) {
    reach.lower[i] = device.axes[i].lower;
    reach.upper[i] = device.axes[i].upper;
  }
  reach.x = device.axisIndex("x");
  reach.y = device.axisIndex("y");
  reach.z = device.axisIndex("z");
  reach.fingers = device.axisIndex("finger_flexion");
  reach.turn = device.axisIndex("thumb_circumduction");
  reach.thumb = device.axisIndex("thumb_flexion");
  const double scale = reach.scale = hand != nullptr ? handScale(*hand) : 1.0;
  reach.beside = hand != nullptr && hand->side == Side::kLeft ? -1.0 : 1.0;
  reach.grip_m = {scale * kAhead_m, reach.beside * (scale * kPalm_m + radius_m), scale * kUp_m};
  return reach;
}

Eigen::Vector3d worldPoint(const BodyState& body, const Eigen::Vector3d& point_m) noexcept {
  return body.position_m.eigen() + body.orientation_xyzw.eigen() * point_m;
}

}  // namespace wholehand
