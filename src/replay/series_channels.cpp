#include "replay/series_channels.hpp"

#include <cmath>
#include <cstddef>
#include <limits>

namespace wholehand {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

double contactForce_n(const TickRecord& record) {
  double sum_n = 0.0;
  for (int i = 0; i < record.contact_count; ++i) {
    sum_n += record.contacts[i].force_n.eigen().norm();
  }
  return sum_n;
}

/// Wall-clock time; on a simulated clock, CPU time.
double duration_s(const TickRecord& record, const RecordingMeta& meta) {
  const bool wall = !meta.simulated_clock && record.wall_ns > 0;
  const std::int64_t duration_ns = wall ? record.wall_ns : record.cpu_ns;
  return duration_ns > 0 ? 1e-9 * static_cast<double>(duration_ns) : kNothing;
}

}  // namespace

std::vector<SeriesChannel> seriesChannels(const RecordingMeta& meta) {
  std::vector<SeriesChannel> channels;
  const auto axes = static_cast<int>(meta.axis_names.size());
  for (const char* name :
       {"q_m", "q_s", "intention", "sent", "exercise_effort", "damping", "phi"}) {
    for (int a = 0; a < axes; ++a) channels.push_back({name, a});
  }
  for (const char* name :
       {"alpha", "palm_distance_m", "contact_force_n", "contact_count", "duration_s"}) {
    channels.push_back({name, 0});
  }
  const auto values = static_cast<int>(meta.value_names.size());
  for (int v = 0; v < values; ++v) channels.push_back({"value", v});
  return channels;
}

void fillSeriesValues(const TickRecord& record, const RecordingMeta& meta,
                      std::vector<double>& values) {
  std::size_t at = 0;
  const auto axes = static_cast<int>(meta.axis_names.size());
  const auto per_axis = [&](const auto& array) {
    for (int a = 0; a < axes; ++a) values[at++] = a < array.size() ? array[a] : kNothing;
  };
  per_axis(record.q_m);
  per_axis(record.q_s);
  per_axis(record.intention);
  per_axis(record.sent);
  per_axis(record.exercise.effort);
  per_axis(record.damping);
  per_axis(record.phi);
  for (const double value : {record.exercise.alpha, record.palm_distance_m, contactForce_n(record),
                             static_cast<double>(record.contact_count), duration_s(record, meta)}) {
    values[at++] = value;
  }
  for (std::size_t v = 0; v < meta.value_names.size(); ++v) {
    values[at++] =
        static_cast<int>(v) < record.exercise.value_count ? record.exercise.values[v] : kNothing;
  }
}

LeftOut leftOutOfSeries() {
  return {{"stage_cpu_ns", "digest", "moved_by", "help", "patient_effort", "theta",
           "coupling_error_rad", "bodies", "effort_limit", "tank", "palm_body",
           "palm_target_distance_m", "parameters"},
          {"capsule", "link", "body", "point_m", "normal", "torque_nm", "distance_m"}};
}

}  // namespace wholehand
