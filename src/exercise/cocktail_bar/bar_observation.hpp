#pragma once

#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/grip.hpp"

#include <Eigen/Core>

#include <array>

namespace wholehand {

/// Evaluation of a tick's observation. Indices are those of Bar::dispensers; -1: none.
struct BarObservation {
  double elapsed_s = 0.0;
  std::array<double, kMaxDispensers> force_n{};    ///< summed normal contact force on each
  std::array<double, kMaxDispensers> squeeze_n{};  ///< filled in once the walls are known
  std::array<bool, kMaxDispensers> touched{};
  std::array<Eigen::Vector3d, kMaxDispensers> at_m;      ///< centre of mass
  std::array<Eigen::Vector3d, kMaxDispensers> nozzle_m;  ///< world
  std::array<double, kMaxDispensers> tilt_rad{};         ///< angle of its axis from vertical
  Eigen::Vector3d glass_m = Eigen::Vector3d::Zero();     ///< centre of mass
  bool touches_any = false;  ///< contact with a dispenser of the row or the glass
  int nearest = -1;          ///< nearest dispenser to the palm, on any side
  double palm_m = 0.0;       ///< palm surface to it; +inf: none, or not before the palm
  bool grips_any = false;    ///< the palmar side holds a dispenser
  bool behind = false;       ///< the hand's x is that of a withdrawn hand
  bool drawn_back = false;   ///< withdrawn, touches nothing and obstructs no sliding row

  /// Whether the flow from the nozzle falls into the glass, regardless of its level.
  [[nodiscard]] WHOLEHAND_RT bool overGlass(int dispenser, const BarGlass& glass) const noexcept;
};

/// Evaluates a record. @param hand in the record's posture. Real-time safe.
[[nodiscard]] WHOLEHAND_RT BarObservation observeBar(const Bar& bar, const TickRecord& record,
                                                     const HandPosture& hand,
                                                     double period_s) noexcept;

}  // namespace wholehand
