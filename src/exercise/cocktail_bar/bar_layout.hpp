#pragma once

#include "core/geometry.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "exercise/cocktail_bar/bar.hpp"
#include "model/device_model.hpp"
#include "model/hand/hand_model.hpp"

#include <array>

namespace wholehand {

/// Geometry that a player of the bar needs: bodies of dispensers and glass, axes that move the
/// hand, and its reach.
struct BarLayout {
  struct Dispenser {
    int body = -1;                     ///< index into the scene's bodies
    Eigen::Vector3d grip_m, nozzle_m;  ///< body frame
    bool free = false;
  };

  int axes = 0;
  AxisPosition lower, upper;  ///< range of the device [m or rad]
  int x = -1, y = -1, z = -1, fingers = -1, turn = -1, thumb = -1;  ///< axis indices; -1: none
  Eigen::Vector3d grip_m;  ///< from the hand's base to the centre of a held dispenser
  double beside = 1.0;     ///< +1 where the palm faces +y (a right hand), -1 where it faces -y
  int dispenser_count = 0;
  std::array<Dispenser, kMaxDispensers> dispensers{};
  int glass_body = -1;
  double glass_top_m = 0.0;  ///< height of its top above its centre
};

/// Makes the layout. @param hand null: the adult median right hand. Not real-time safe.
[[nodiscard]] BarLayout makeBarLayout(const Bar& bar, const DeviceModel& device,
                                      const HandModel* hand);

/// Region to which the device can bring the palm, extended by `slack_m`.
[[nodiscard]] BarReach reachOf(const BarLayout& layout, double slack_m) noexcept;

/// World position of a point in a body's frame.
[[nodiscard]] WHOLEHAND_RT Eigen::Vector3d worldPoint(const BodyState& body,
                                                      const Eigen::Vector3d& point_m) noexcept;

}  // namespace wholehand
