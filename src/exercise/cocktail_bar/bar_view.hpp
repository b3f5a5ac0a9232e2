#pragma once

#include "core/geometry.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "exercise/cocktail_bar/bar.hpp"
#include "exercise/cocktail_bar/recipe.hpp"
#include "model/device_model.hpp"
#include "model/hand_model.hpp"

#include <array>

namespace wholehand {

/// What somebody who plays the bar must know to find dispensers in a record, and the measure of the
/// own hand.
struct BarView {
  struct Dispenser {
    int body = -1;                     ///< index into the scene's bodies
    Eigen::Vector3d grip_m, nozzle_m;  ///< body frame
    bool free = false;
  };

  int axes = 0;
  AxisPosition lower, upper;                                        ///< of the device [m or rad]
  int x = -1, y = -1, z = -1, fingers = -1, turn = -1, thumb = -1;  ///< axes; -1: it has none
  Eigen::Vector3d grip_m;  ///< from the hand's base to the middle of a dispenser that it holds
  double beside = 1.0;     ///< +1 where the palm faces +y (a right hand), -1 where it faces -y
  int dispenser_count = 0;
  std::array<Dispenser, kMaxDispensers> dispensers{};
  int glass_body = -1;
  double glass_top_m = 0.0;  ///< of its centre
};

/// @param hand null: the adult median right one. Not real-time safe.
[[nodiscard]] BarView makeBarView(const Bar& bar, const DeviceModel& device, const HandModel* hand);

/// Where the device can bring the palm to a dispenser, within `slack_m` of it.
[[nodiscard]] BarReach reachOf(const BarView& view, double slack_m) noexcept;

/// What can be seen at a glance.
struct BarGlance {
  BarStage stage = BarStage::kReach;
  int drink = 0, step = 0, target = -1, engaged = -1;
  double squeeze_n = 0.0, low_n = 0.0, high_n = 0.0;
  double flow_l_s = 0.0, poured_l = 0.0, asked_l = 0.0;
};
[[nodiscard]] WHOLEHAND_RT BarGlance glance(const ExerciseRecord& record) noexcept;

/// A point of a body's frame in the world.
[[nodiscard]] WHOLEHAND_RT Eigen::Vector3d worldPoint(const BodyState& body,
                                                      const Eigen::Vector3d& point_m) noexcept;

}  // namespace wholehand
