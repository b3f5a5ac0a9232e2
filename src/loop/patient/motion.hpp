#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/real_time.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"
#include "loop/patient/player.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// A recorded motion read from CSV: columns `time_s` and any of `<axis>_m`, `<axis>_rad`.
struct MotionFile {
  std::string path;
  std::vector<std::string> columns;          ///< without time_s, unit suffix removed: "x", ...
  std::vector<double> time_s;                ///< strictly increasing, any start
  std::vector<std::vector<double>> samples;  ///< one row per time, one value per column
  Diagnostics notices;                       ///< columns that are ignored, and a pace of minutes
};

/// A pose to reach at a time; the motion between two is minimum-jerk.
struct Waypoint {
  double time_s = 0.0;
  AxisPosition q;
};

/// Target of the person as a function of time: positions with continuous velocity. Holds the first
/// pose before the start and the last one after the end, at rest.
class Intention {
 public:
  /// Minimum-jerk motion between waypoints, at rest at each of them.
  /// @pre waypoints not empty, times strictly increasing, all of one size
  static Intention throughWaypoints(std::vector<Waypoint> waypoints);

  /// A recorded motion in the device's coordinates, starting at time 0. Columns that the device
  /// lacks are ignored. Axes that the file lacks rest at `rest` (clamped to their range).
  ///
  /// 1. Resampling at 100 Hz, with the playing rate eased in and out over 0.2 s, and zero-phase
  ///    smoothing: taps (1 2 1)/4, then a uniform cubic B-spline with the result as control points;
  ///    together -3 dB at 14 Hz, continuous acceleration, never outside the samples' hull.
  /// 2. Base translations are scaled equally and shifted into the workspace less the margin. Every
  ///    other axis, and a translation that a given scale does not fit, is compressed smoothly
  ///    (slope <= 1, tanh over the last 5 % of the range) to stay inside.
  /// 3. Time is stretched equally for all axes until every speed is at most speed_share of the
  ///    limit.
  ///
  /// `report` (may be null) receives a description in sentences. Not real-time safe.
  static Intention fromMotion(const MotionFile& motion, const MotionMapping& mapping,
                              const DeviceModel& device, const AxisPosition& rest,
                              std::vector<std::string>* report);

  /// Target position and velocity at a time. O(log n) in the number of knots. Real-time safe.
  WHOLEHAND_RT void evaluate(double time_s, AxisPosition& q, AxisVelocity& qd) const noexcept;

  /// Time at which the last pose is reached, from time 0 [s].
  [[nodiscard]] double duration_s() const noexcept;
  /// The first pose.
  [[nodiscard]] AxisPosition start() const noexcept;

 private:
  std::vector<Waypoint> knots_;
  std::vector<AxisVelocity> velocities_;  ///< one per knot; empty when minimum_jerk_
  bool minimum_jerk_ = false;
};

/// Plays an intention by time, regardless of the hand. Time is counted in periods, so that a
/// skipped and a waited period give the same bits.
class ScriptedPlayer final : public Player {
 public:
  /// @param mover kMotion, or kNobody when the intention is to rest
  explicit ScriptedPlayer(Intention intention, Mover mover = Mover::kMotion);

  [[nodiscard]] AxisPosition start() const override;
  void reset() override { periods_ = 0; }
  /// @pre the same period as in every other call since reset()
  WHOLEHAND_RT void advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept override;
  WHOLEHAND_RT void onRecord(const TickRecord&) noexcept override {}
  [[nodiscard]] WHOLEHAND_RT Mover mover() const noexcept override { return mover_; }

 private:
  Intention intention_;
  Mover mover_;
  std::int64_t periods_ = 0;
};

}  // namespace wholehand
