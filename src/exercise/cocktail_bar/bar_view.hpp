#pragma once

#include "core/geometry.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"
#include "exercise/exercise.hpp"
#include "model/device_model.hpp"
#include "model/hand_model.hpp"
#include "model/scene_model.hpp"

#include <array>

namespace wholehand {

/// The parts of the exercise, as its value `stage` counts them.
enum class BarStage { kReach, kSqueeze, kPouring, kLetGo, kDrinkDone, kLevelDone, kDrawBack };

/// What somebody who plays must know to find dispensers and figures in a record: names of the
/// exercise's description resolved to indices, and the measure of the own hand.
struct BarView {
  static constexpr int kMost = 8;  ///< dispensers
  struct Dispenser {
    int body = -1;  ///< index into the scene's bodies
    Vec3 grip_m;    ///< body frame
    Vec3 nozzle_m;  ///< body frame
    bool free = false;
  };
  struct Values {
    int stage = -1, step = -1, drink = -1, target = -1, engaged = -1;
    int squeeze_n = -1, low_n = -1, high_n = -1, flow_l_s = -1, over_glass = -1;
    int poured_l = -1, asked_l = -1, tolerance_l = -1;
  };

  int axes = 0;
  AxisPosition lower, upper;                                        ///< of the device [m or rad]
  int x = -1, y = -1, z = -1, fingers = -1, turn = -1, thumb = -1;  ///< axes; -1: it has none
  Vec3 grip_m;        ///< from the hand's base to the middle of a dispenser that it holds
  double beside = 1;  ///< +1 where the palm faces +y (a right hand), -1 where it faces -y
  int dispenser_count = 0;
  std::array<Dispenser, kMost> dispensers{};
  int glass_body = -1;
  double glass_top_m = 0.0;  ///< of its centre
  Values values;
};

/// Resolves it. What the description does not name stays -1. Not real-time safe.
[[nodiscard]] BarView makeBarView(const ExerciseDescription& description, const DeviceModel& device,
                                  const HandModel& hand, const SceneModel& scene);

/// What can be seen at a glance.
struct BarGlance {
  BarStage stage = BarStage::kReach;
  int drink = 0, step = 0, target = -1, engaged = -1;
  double squeeze_n = 0.0, low_n = 0.0, high_n = 0.0;
  double flow_l_s = 0.0, poured_l = 0.0, asked_l = 0.0, tolerance_l = 0.0;
  bool over_glass = false;
};
[[nodiscard]] WHOLEHAND_RT BarGlance glance(const BarView& view,
                                            const ExerciseRecord& record) noexcept;

/// A point of a body's frame in the world.
[[nodiscard]] WHOLEHAND_RT Eigen::Vector3d worldPoint(const BodyState& body,
                                                      const Vec3& point_m) noexcept;

}  // namespace wholehand
