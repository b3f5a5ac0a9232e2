#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "model/device_model.hpp"
#include "model/patient_config.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A recorded motion as read from CSV: columns `time_s` and any of `<axis>_m`, `<axis>_rad`.
struct MotionFile {
  std::string path;
  std::vector<std::string> columns;          ///< without time_s, unit suffix removed: "x", ...
  std::vector<double> time_s;                ///< strictly increasing, starts anywhere
  std::vector<std::vector<double>> samples;  ///< one row a time, one value a column
};

/// Reads and checks a motion file: not empty, not ragged, finite, within ±1000, strictly increasing
/// time of at most an hour, known unit suffixes, known axes, no column twice. Known are the nine
/// usual axes and, when `device` is given, its own; an axis's unit must be the device's. Lines that
/// start with # and empty lines are skipped. Every fault is reported at once (the first 20).
/// Not real-time safe.
[[nodiscard]] Expected<MotionFile> loadMotionFile(const std::string& path,
                                                  const DeviceModel* device = nullptr);

/// A pose to be at, at a time; the motion between two is minimum-jerk.
struct Waypoint {
  double time_s = 0.0;
  AxisPosition q;
};

/// Where the person wants to be, as a function of time: positions with continuous velocity. Before
/// the start it holds the first pose, after the end the last, both at rest.
class Intention {
 public:
  /// Minimum jerk from each waypoint to the next, at rest at each of them.
  /// @pre waypoints not empty, times strictly increasing, all of one size
  static Intention throughWaypoints(std::vector<Waypoint> waypoints);

  /// A recorded motion in the device's coordinates, starting at time 0. Columns the device does not
  /// have are ignored, axes the file does not have rest at `rest` (held inside their range).
  ///
  /// 1. Resampled at 100 Hz, with the playing rate eased in and out over 0.2 s, and smoothed
  /// without
  ///    delay: taps (1 2 1)/4, then a uniform cubic B-spline through the result as control points;
  ///    together -3 dB at 14 Hz, continuous acceleration, never outside the samples' hull.
  /// 2. Base translations: scaled alike and shifted into the workspace less the margin. Every other
  ///    axis, and a translation that a given scale does not fit: bent smoothly (slope <= 1, tanh
  ///    over the last 5 % of the range) so as to stay inside.
  /// 3. Time is stretched alike for all axes until every speed is at most speed_share of the limit.
  ///
  /// `report` (may be null) says in sentences what was done. Not real-time safe.
  static Intention fromMotion(const MotionFile& motion, const MotionMapping& mapping,
                              const DeviceModel& device, const AxisPosition& rest,
                              std::vector<std::string>* report);

  /// Position and velocity wanted at a time. O(log n) in the number of knots. Real-time safe.
  WHOLEHAND_RT void evaluate(double time_s, AxisPosition& q, AxisVelocity& qd) const noexcept;

  /// The time at which the last pose is reached, counted from time 0 [s].
  [[nodiscard]] double duration_s() const noexcept;
  /// The first pose.
  [[nodiscard]] AxisPosition start() const noexcept;

 private:
  std::vector<Waypoint> knots_;
  std::vector<AxisVelocity> velocities_;  ///< one a knot; empty when minimum_jerk_
  bool minimum_jerk_ = false;
};

}  // namespace wholehand
