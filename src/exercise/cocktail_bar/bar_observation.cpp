#include "exercise/cocktail_bar/bar_observation.hpp"

#include "exercise/grip.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

int dispenserOf(const Bar& bar, int body) noexcept {
  for (std::size_t i = 0; i < bar.dispensers.size(); ++i) {
    if (bar.dispensers[i].body_index == body) return static_cast<int>(i);
  }
  return -1;
}

void senseContacts(const Bar& bar, const TickRecord& record, BarObservation& out) noexcept {
  for (int k = 0; k < record.contact_count; ++k) {
    const Contact& c = record.contacts[k];
    const int at = dispenserOf(bar, c.body);
    if (at < 0 && c.body != bar.glass.body_index) continue;
    const double normal_n = c.force_n.eigen().dot(c.normal.eigen());
    if (!(normal_n > 0.0)) continue;  // a nearby point without force
    out.touches_any = true;
    if (at < 0) continue;
    out.force_n[at] += normal_n;
    out.touched[at] = true;
  }
}

}  // namespace

BarObservation observeBar(const Bar& bar, const TickRecord& record, const HandPosture& hand,
                          double period_s) noexcept {
  BarObservation out;
  out.elapsed_s = std::max(record.elapsed_periods, 1U) * period_s;
  senseContacts(bar, record, out);
  for (std::size_t i = 0; i < bar.dispensers.size(); ++i) {
    const BarDispenser& d = bar.dispensers[i];
    const bool grips = out.touched[i] && gripForce_n(record, d.body_index, hand) > 0.0;
    out.grips_any = out.grips_any || grips;
    const BodyState& body = record.bodies[d.body_index];
    const Eigen::Matrix3d turn = body.orientation_xyzw.eigen().toRotationMatrix();
    out.at_m[i] = body.position_m.eigen();
    out.nozzle_m[i] = out.at_m[i] + turn * d.nozzle_m;
    out.tilt_rad[i] = std::acos(std::clamp(turn(2, 2), -1.0, 1.0));
  }
  out.glass_m = record.bodies[bar.glass.body_index].position_m.eigen();
  out.nearest = dispenserOf(bar, record.palm_body);
  const double to_nearest_m = record.palm_target_distance_m;
  out.palm_m = to_nearest_m < 0.0 ? std::numeric_limits<double>::infinity() : to_nearest_m;
  out.behind = bar.x_axis < 0 || record.q_s[bar.x_axis] < bar.drawn_back.x_m;
  out.drawn_back =
      out.behind && std::abs(to_nearest_m) >= bar.drawn_back.palm_m && !out.touches_any;
  return out;
}

bool BarObservation::overGlass(int dispenser, const BarGlass& glass) const noexcept {
  const Eigen::Vector3d from_glass = nozzle_m[dispenser] - glass_m;
  return from_glass.head<2>().norm() < glass.inner_radius_m &&
         from_glass.z() > 0.5 * glass.height_m;
}

}  // namespace wholehand
