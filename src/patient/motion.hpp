#pragma once

#include <string>
#include <vector>

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "core/real_time.hpp"
#include "model/device_model.hpp"
#include "model/patient_config.hpp"

namespace wholehand {

/// A recorded motion as read from CSV: columns `time_s` and any of `<axis>_m`, `<axis>_rad`.
struct MotionFile {
  std::string path;
  std::vector<std::string> columns;           ///< without time_s, unit suffix removed: "x", ...
  std::vector<double> time_s;                 ///< strictly increasing, starts anywhere
  std::vector<std::vector<double>> samples;   ///< one row a time, one value a column
};

/// Reads and checks a motion file: not empty, not ragged, finite, strictly increasing time, known
/// unit suffixes.
[[nodiscard]] Expected<MotionFile> loadMotionFile(const std::string& path);

/// A pose to be at, at a time; the motion between two is minimum-jerk.
struct Waypoint {
  double time_s = 0.0;
  AxisPosition q;
};

/// Where the person wants to be, as a function of time: positions with continuous velocity. Before
/// the start it holds the first pose, after the end the last. evaluate() is real-time safe.
class Intention {
 public:
  /// Minimum-jerk through waypoints. @pre waypoints not empty, times strictly increasing
  static Intention throughWaypoints(std::vector<Waypoint> waypoints);

  /// A recorded motion in the device's coordinates. Columns the device does not have are ignored,
  /// axes the file does not have rest at `rest`. Translations are shifted, scaled and clamped into the
  /// workspace, rotations clamped into their range, and time is stretched until every speed is allowed;
  /// `report` says in sentences what was done.
  static Intention fromMotion(const MotionFile& motion, const MotionMapping& mapping,
                              const DeviceModel& device, const AxisPosition& rest,
                              std::vector<std::string>* report);

  WHOLEHAND_RT void evaluate(double time_s, AxisPosition& q, AxisVelocity& qd) const noexcept;

  [[nodiscard]] double duration_s() const noexcept;
  [[nodiscard]] AxisPosition start() const noexcept;

 private:
  std::vector<Waypoint> knots_;
  std::vector<AxisVelocity> velocities_;
  bool minimum_jerk_ = false;
};

}  // namespace wholehand
