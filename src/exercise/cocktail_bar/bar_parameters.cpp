#include "exercise/cocktail_bar/bar_parameters.hpp"

#include "core/geometry.hpp"

#include <algorithm>
#include <utility>

namespace wholehand {
namespace {

constexpr double kRamp_s = 1.0;  // ramp time over the whole range
/// Lateral offset of the hand's lane beside a dispenser, on the side of its back; the same in the
/// pages.
constexpr double kLane_m = 0.024;
/// A dispenser needs room beside the hand. Half-bent fingers of a withdrawn hand must clear the
/// row, or it stops on its way.
constexpr double kLeastAside_m = 0.03, kLeastForward_m = 0.06;
/// A bottle is gripped at about 131 degrees; half-bent fingers pass beside it.
constexpr double kLeastClosed_rad = 140.0 * kDeg, kMostOpen_rad = 45.0 * kDeg;
constexpr double kFinest_l = 0.001, kWidest_l = 0.012;
constexpr double kShortestFade_s = 0.3, kLongestFade_s = 5.0;

LiveParameter ranged(const char* name, const char* unit, double lower, double upper, double value) {
  lower = std::min(lower, value);
  upper = std::max(upper, value);
  return {name, unit, lower, upper, value, (upper - lower) / kRamp_s};
}

}  // namespace

BarParameters::BarParameters(const Bar& bar, const BarLayout& layout)
    : row_(bar.row),
      beside_(layout.beside),
      grip_x_m_(bar.dispensers.front().home_m.x() + bar.dispensers.front().grip_m.x() -
                layout.grip_m.x()),
      grip_y_m_(bar.dispensers.front().grip_m.y() - layout.grip_m.y()) {
  all_ = {{"wall_stiffness_ratio", "1", 0.0, kLargestWallRatio, 1.0, 0.5},
          {"viscosity_ratio", "1", kThinnestRatio, kThickestRatio, 1.0, 0.5},
          {"lead_in_m", "m", 0.0, kLargestLeadIn_m, bar.lead_in_m, 0.005},
          {"squeeze_threshold_ratio", "1", 0.25, 2.0, 1.0, 0.5},
          ranged("line_tolerance_l", "l", kFinest_l, kWidest_l,
                 bar.drinks.front().steps.front().tolerance_l),
          ranged("wall_fade_s", "s", kShortestFade_s, kLongestFade_s, bar.transition.engage_s)};
  if (layout.y >= 0) {
    const double left_m = layout.upper[layout.y], right_m = -layout.lower[layout.y];
    left_ = add(ranged("reach_left_m", "m", kLeastAside_m, left_m, left_m));
    right_ = add(ranged("reach_right_m", "m", kLeastAside_m, right_m, right_m));
  }
  if (layout.x >= 0) {
    const double forward_m = layout.upper[layout.x];
    forward_ = add(ranged("reach_forward_m", "m", kLeastForward_m, forward_m, forward_m));
  }
  if (layout.fingers >= 0) {
    const double open_rad = layout.lower[layout.fingers], close_rad = layout.upper[layout.fingers];
    add(ranged("fingers_open_rad", "rad", open_rad, kMostOpen_rad, open_rad));
    add(ranged("fingers_close_rad", "rad", kLeastClosed_rad, close_rad, close_rad));
  }
}

int BarParameters::add(LiveParameter parameter) {
  all_.push_back(std::move(parameter));
  return static_cast<int>(all_.size()) - 1;
}

RowReach BarParameters::reach(const double* v) const noexcept {
  RowReach out{row_.reach_lower_m, row_.reach_upper_m, 0.0};
  if (left_ >= 0) {
    // The hand stays between its lane, on the side of its back, and the grip.
    const double lane_left_m = beside_ < 0.0 ? kLane_m : 0.0;
    const double lane_right_m = beside_ > 0.0 ? kLane_m : 0.0;
    const double lower_m = -v[right_] + lane_right_m - grip_y_m_;
    const double upper_m = v[left_] - lane_left_m - grip_y_m_;
    const double middle_m =
        std::clamp(0.5 * (lower_m + upper_m), row_.reach_lower_m, row_.reach_upper_m);
    out.lower_m = std::clamp(lower_m, row_.reach_lower_m, middle_m);
    out.upper_m = std::clamp(upper_m, middle_m, row_.reach_upper_m);
  }
  if (forward_ >= 0 && row_.slides) out.nearer_m = std::max(0.0, grip_x_m_ - v[forward_]);
  return out;
}

}  // namespace wholehand
