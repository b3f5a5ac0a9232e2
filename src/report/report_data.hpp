#pragma once

#include "core/expected.hpp"
#include "report/decimation.hpp"
#include "report/touch_log.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/statistics.hpp"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

/// Which plot an axis belongs to.
enum class AxisRole { kArm, kWrist, kHand };

/// One axis of the recording's device, as people read it.
struct ReportAxis {
  std::string name;
  AxisRole role = AxisRole::kHand;
  std::string effort_unit;      ///< "N" or "N·m"; N at the tip where the lever arm is known
  double effort_scale = 1.0;    ///< recorded effort -> shown effort
  double position_scale = 1.0;  ///< recorded position -> mm or degrees
  double effort_limit = 0.0;    ///< shown unit
  double largest_effort = 0.0;  ///< |sent|, shown unit
  std::vector<PlotPoint> effort, device, avatar, phi;
};

/// Everything that the page shows, from one pass over a recording of any length.
struct ReportData {
  RecordingMeta meta;
  std::string path;
  double from_s = 0.0, to_s = 0.0;  ///< first tick's time; last tick's time and one period
  TickSummary summary;
  std::vector<ReportAxis> axes;
  std::vector<BodyStory> bodies;
  std::vector<Touch> touches;  ///< of all bodies, by time
  std::vector<PlotPoint> contact_force_n, contact_count, palm_distance_mm;
  double largest_contact_force_n = 0.0;
  TickRecord largest_contact;  ///< the first tick with that force; without any, the first of all
  bool cpu_time = false;       ///< simulated clock or no wall time: durations are CPU time
  std::vector<std::uint64_t> durations;  ///< ticks in steps of 1 % of the period; the last: beyond
  std::uint64_t missing_ticks = 0;  ///< between those that the file holds; lines are broken there
  double emergency_stop_s = -1.0;   ///< when the first was heard; -1: none was
  double damped_share = 0.0;        ///< of the time with some Φ above 0.5
};

/// Reads a recording once. `columns`: pixels across a plot; `progress` hears now and then how much
/// is read, 0 to 1.
[[nodiscard]] Expected<ReportData> collectReport(const std::string& recording_path, int columns,
                                                 const std::function<void(double)>& progress = {});

/// "lambda-pride" from the embedded file of that kind ("device", "hand", "scene" ...); empty when
/// there is none.
[[nodiscard]] std::string embeddedName(const RecordingMeta& meta, const std::string& kind);

}  // namespace wholehand
