#pragma once

#include "loop/control/corridor.hpp"
#include "loop/control/limit_wall.hpp"
#include "loop/core/axis_array.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"

#include <array>
#include <optional>

namespace wholehand {

/// Walls and corridor of a prescription, resolved for a device.
struct PersonGuidesConfig {
  LimitWallConfig walls;
  std::optional<CorridorConfig> corridor;
  std::array<int, 3> translations{-1, -1, -1};  ///< axes x, y, z; -1: the device lacks it
};

/// The efforts of a prescription in the tick: they resist and never lead (ADR 102). While they are
/// not allowed, they fall to 0 within CorridorConfig::kFall_s; then they begin anew, where the hand
/// is. Real-time safe.
class PersonGuides {
 public:
  explicit PersonGuides(const PersonGuidesConfig& config);

  /// Begins at a place of the hand: at arming.
  WHOLEHAND_RT void begin(const AxisPosition& q_m) noexcept;
  /// Computes effort and stored energy of this tick.
  WHOLEHAND_RT void advance(const AxisPosition& q_m, const MovementGoal& goal, bool allowed,
                            double elapsed_s) noexcept;
  /// Gives no effort, after a fault.
  WHOLEHAND_RT void clear() noexcept;
  /// Keeps the effort of an exercise from rising within a limit's band: there the limit's wall is
  /// the only spring.
  WHOLEHAND_RT void boundExercise(const AxisPosition& q_m, ExerciseRecord& exercise) noexcept;

  [[nodiscard]] const AxisEffort& effort() const noexcept { return effort_; }
  [[nodiscard]] const AxisEnergy& stored_j() const noexcept { return stored_j_; }

 private:
  [[nodiscard]] Eigen::Vector3d placeOf(const AxisPosition& q_m) const noexcept;
  [[nodiscard]] MovementGoal reachable(const MovementGoal& goal) const noexcept;
  [[nodiscard]] bool withinBands(int axis, double q) const noexcept;
  WHOLEHAND_RT void pushByCorridor(const AxisPosition& q_m, const MovementGoal& goal, bool allowed,
                                   double elapsed_s) noexcept;

  const PersonGuidesConfig config_;
  LimitWallState walls_;
  double scale_ = 1.0;  ///< of the walls
  CorridorState corridor_;
  AxisEffort exercise_edge_;  ///< |effort| of the exercise when the axis was last outside the bands
  AxisEffort effort_;
  AxisEnergy stored_j_;
};

}  // namespace wholehand
