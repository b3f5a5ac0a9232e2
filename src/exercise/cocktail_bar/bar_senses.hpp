#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/hand_posture.hpp"

#include <Eigen/Core>

#include <array>

namespace wholehand {

/// What the bar makes of a tick's observation. Indices are those of Bar::dispensers, -1: none.
struct BarSenses {
  double elapsed_s = 0.0;
  std::array<double, kMaxDispensers> force_n{};    ///< summed normal contact force on each
  std::array<double, kMaxDispensers> squeeze_n{};  ///< filled in when the walls are known
  std::array<bool, kMaxDispensers> touched{};
  std::array<Eigen::Vector3d, kMaxDispensers> at_m;      ///< centre of mass
  std::array<Eigen::Vector3d, kMaxDispensers> nozzle_m;  ///< world
  std::array<double, kMaxDispensers> tilt_rad{};         ///< of its axis from upright
  Eigen::Vector3d glass_m = Eigen::Vector3d::Zero();     ///< centre of mass
  bool touches_any = false;                              ///< a dispenser of the row or the glass
  int nearest = -1;                                      ///< to the palm, on any side
  double palm_m = 0.0;  ///< palm surface to it; +inf without, and where it is not before the palm
  bool grips_any = false;   ///< a dispenser is held by the palmar side
  bool behind = false;      ///< the hand is as far back as a hand that is drawn back
  bool drawn_back = false;  ///< nothing in the way of a sliding row, nothing touched

  /// Whether what leaves the nozzle falls into the glass (were it not full).
  [[nodiscard]] WHOLEHAND_RT bool overGlass(int dispenser, const BarGlass& glass) const noexcept;
};

/// @param hand in the record's posture. Real-time safe.
[[nodiscard]] WHOLEHAND_RT BarSenses senseBar(const Bar& bar, const TickRecord& record,
                                              const HandPosture& hand, double period_s) noexcept;

}  // namespace wholehand
