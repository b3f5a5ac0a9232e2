#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/cocktail_bar/bar_layout.hpp"

#include <vector>

namespace wholehand {

/// Range of the row for the reach of an arm.
struct RowReach {
  double lower_m = 0.0, upper_m = 0.0;  ///< y range of the target dispenser
  double nearer_m = 0.0;                ///< the row is nearer than in the scene by this, >= 0
};

/// Live parameters of the bar, set by a therapist. Parameters of axes that the device lacks are
/// left out.
///
///   wall_stiffness_ratio, viscosity_ratio   factors on those of the file
///   lead_in_m, squeeze_threshold_ratio         as in the file; factor on those of the level
///   line_tolerance_l    of every step; at least a tenth of what it asks for stays to be poured
///   wall_fade_s         T_on: how long a wall takes to fade in
///   reach_left_m, reach_right_m, reach_forward_m   from the device's middle: how far the person's
///                       hand goes. The row comes within it; pages keep their aim within it
///   fingers_open_rad, fingers_close_rad   how far the fingers open and close: pages ask no more
class BarParameters {
 public:
  BarParameters(const Bar& bar, const BarLayout& layout);

  [[nodiscard]] const std::vector<LiveParameter>& all() const noexcept { return all_; }

  // Accessors of the current values, in the order of all(). Real-time safe.
  [[nodiscard]] WHOLEHAND_RT double stiffness(const double* v) const noexcept { return v[0]; }
  [[nodiscard]] WHOLEHAND_RT double viscosity(const double* v) const noexcept { return v[1]; }
  [[nodiscard]] WHOLEHAND_RT double leadIn_m(const double* v) const noexcept { return v[2]; }
  [[nodiscard]] WHOLEHAND_RT double threshold(const double* v) const noexcept { return v[3]; }
  [[nodiscard]] WHOLEHAND_RT double tolerance_l(const double* v) const noexcept { return v[4]; }
  [[nodiscard]] WHOLEHAND_RT double fade_s(const double* v) const noexcept { return v[5]; }
  [[nodiscard]] WHOLEHAND_RT RowReach reach(const double* v) const noexcept;

 private:
  int add(LiveParameter parameter);

  const BarRow row_;
  const double beside_;                     ///< BarLayout::beside of the hand
  double grip_x_m_ = 0.0, grip_y_m_ = 0.0;  ///< y: of the hand at a dispenser at y = 0
  int left_ = -1, right_ = -1, forward_ = -1;
  std::vector<LiveParameter> all_;
};

}  // namespace wholehand
