#include "report/report_data.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace wholehand {
namespace {

constexpr double kDegrees = 180.0 / 3.14159265358979323846;
/// Steps of 1 % of the period, up to three periods, and one for all beyond.
constexpr std::size_t kDurationSteps = 301;
constexpr std::uint64_t kTicksBetweenProgress = 10'000;

bool startsWith(const std::string& text, const char* head) {
  return text.rfind(head, 0) == 0;
}

AxisRole roleOf(const std::string& name, bool rotation) {
  if (!rotation) return AxisRole::kArm;
  for (const char* wrist : {"roll", "pitch", "yaw", "wrist"}) {
    if (startsWith(name, wrist)) return AxisRole::kWrist;
  }
  return AxisRole::kHand;
}

ReportAxis describeAxis(const RecordingMeta& meta, std::size_t i) {
  ReportAxis axis;
  const bool rotation = meta.axis_units[i] == "rad";
  const double lever_m = meta.lever_arms_m[i];
  axis.name = meta.axis_names[i];
  axis.role = roleOf(axis.name, rotation);
  axis.effort_scale = rotation && lever_m > 0.0 ? 1.0 / lever_m : 1.0;
  axis.effort_unit = rotation && !(lever_m > 0.0) ? "N·m" : "N";
  axis.position_scale = rotation ? kDegrees : 1000.0;
  axis.effort_limit = meta.effort_limits[i] * axis.effort_scale;
  return axis;
}

/// Which side of a grasp a capsule stands on.
enum class Grip { kFinger, kThumb, kPalm };
Grip gripOf(const std::string& capsule) {
  if (startsWith(capsule, "thumb")) return Grip::kThumb;
  for (const char* finger : {"index", "middle", "ring", "little"}) {
    if (startsWith(capsule, finger)) return Grip::kFinger;
  }
  return Grip::kPalm;
}

/// What one tick's contacts with one body come to.
struct Grasp {
  bool touching = false;
  double force_n = 0.0;
  std::array<bool, 3> grips{};
  [[nodiscard]] bool held() const { return grips[0] && (grips[1] || grips[2]); }
};

class Collector {
 public:
  Collector(const RecordingMeta& meta, double from_s, double to_s, int columns);
  void add(const TickRecord& r);
  void finish(ReportData& data) const;

 private:
  struct AxisSeries {
    Decimator effort, device, avatar, phi;
  };
  void breakLines(const TickRecord& r);
  void addAxes(const TickRecord& r);
  void addContacts(const TickRecord& r);
  void addDuration(const TickRecord& r);

  const RecordingMeta& meta_;
  std::vector<ReportAxis> axes_;
  std::vector<AxisSeries> series_;
  Decimator force_, count_, palm_;
  std::vector<TouchLog> bodies_;
  std::vector<Grip> grips_;
  TickStatistics statistics_;
  std::vector<std::uint64_t> wall_, cpu_;
  double largest_force_n_ = 0.0;
  TickRecord largest_;
  std::uint64_t damped_ = 0, records_ = 0, missing_ticks_ = 0, last_tick_ = 0;
  double emergency_stop_s_ = -1.0;
};

Collector::Collector(const RecordingMeta& meta, double from_s, double to_s, int columns)
    : meta_(meta),
      force_(from_s, to_s, columns),
      count_(from_s, to_s, columns),
      palm_(from_s, to_s, columns),
      wall_(kDurationSteps, 0),
      cpu_(kDurationSteps, 0) {
  const Decimator fresh(from_s, to_s, columns);
  for (std::size_t i = 0; i < meta.axis_names.size(); ++i) {
    axes_.push_back(describeAxis(meta, i));
    series_.push_back({fresh, fresh, fresh, fresh});
  }
  for (std::size_t b = 0; b < meta.body_names.size(); ++b) {
    bodies_.emplace_back(static_cast<int>(b), meta.body_names[b]);
  }
  for (const std::string& name : meta.capsule_names) grips_.push_back(gripOf(name));
}

// Where ticks are missing nothing is known: no line leads across.
void Collector::breakLines(const TickRecord& r) {
  const std::uint64_t next = last_tick_ + r.elapsed_periods;
  if (records_ == 0 || r.tick <= next) return;
  missing_ticks_ += r.tick - next;
  const double at_s = static_cast<double>(next) * meta_.period_s, nothing = std::nan("");
  for (AxisSeries& s : series_) {
    for (Decimator* line : {&s.effort, &s.device, &s.avatar, &s.phi}) line->add(at_s, nothing);
  }
  for (Decimator* line : {&force_, &count_, &palm_}) line->add(at_s, nothing);
}

void Collector::add(const TickRecord& r) {
  breakLines(r);
  last_tick_ = r.tick;
  if (emergency_stop_s_ < 0.0 && any(r.faults & Fault::kEmergencyStop)) {
    emergency_stop_s_ = r.time_s;
  }
  statistics_.add(r);
  addAxes(r);
  addContacts(r);
  addDuration(r);
  palm_.add(r.time_s, r.palm_distance_m * 1000.0);
  const bool damped = std::any_of(r.phi.begin(), r.phi.end(), [](double v) { return v > 0.5; });
  damped_ += damped ? 1 : 0;
  ++records_;
}

void Collector::addAxes(const TickRecord& r) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const int k = static_cast<int>(i);
    ReportAxis& axis = axes_[i];
    AxisSeries& s = series_[i];
    const auto value = [k](const auto& array, double scale) {
      return k < array.size() ? array[k] * scale : std::nan("");
    };
    const double effort = value(r.sent, axis.effort_scale);
    if (std::isfinite(effort))
      axis.largest_effort = std::max(axis.largest_effort, std::abs(effort));
    s.effort.add(r.time_s, effort);
    s.device.add(r.time_s, value(r.q_m, axis.position_scale));
    s.avatar.add(r.time_s, value(r.q_s, axis.position_scale));
    s.phi.add(r.time_s, value(r.phi, 1.0));
  }
}

void Collector::addContacts(const TickRecord& r) {
  std::array<Grasp, kMaxBodies> grasps{};
  double sum_n = 0.0;
  for (int c = 0; c < r.contact_count; ++c) {
    const Contact& contact = r.contacts[static_cast<std::size_t>(c)];
    const double force_n = contact.force_n.eigen().norm();
    sum_n += force_n;
    if (contact.body < 0 || contact.body >= kMaxBodies) continue;
    Grasp& grasp = grasps[static_cast<std::size_t>(contact.body)];
    grasp.touching = true;
    grasp.force_n += force_n;
    const auto capsule = static_cast<std::size_t>(std::max(contact.capsule, 0));
    const Grip grip = capsule < grips_.size() ? grips_[capsule] : Grip::kPalm;
    grasp.grips[static_cast<std::size_t>(grip)] = true;
  }
  const double duration_s = meta_.period_s * std::max<std::uint32_t>(r.elapsed_periods, 1);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const Grasp& g = grasps[b];
    bodies_[b].contact(r.time_s, duration_s, g.touching, g.force_n, g.held());
    if (static_cast<int>(b) < r.body_count) bodies_[b].position(r.bodies[b].position_m.eigen());
  }
  if (records_ == 0 || sum_n > largest_force_n_) largest_ = r;
  force_.add(r.time_s, sum_n);
  count_.add(r.time_s, r.contact_count);
  largest_force_n_ = std::max(largest_force_n_, sum_n);
}

void Collector::addDuration(const TickRecord& r) {
  const auto step = [this](std::int64_t ns) {
    const double share = static_cast<double>(ns) * 1e-9 / meta_.period_s * 100.0;
    return static_cast<std::size_t>(
        std::clamp(share, 0.0, static_cast<double>(kDurationSteps - 1)));
  };
  ++wall_[step(r.wall_ns)];
  ++cpu_[step(r.cpu_ns)];
}

void Collector::finish(ReportData& data) const {
  data.axes = axes_;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    data.axes[i].effort = series_[i].effort.points();
    data.axes[i].device = series_[i].device.points();
    data.axes[i].avatar = series_[i].avatar.points();
    data.axes[i].phi = series_[i].phi.points();
  }
  data.contact_force_n = force_.points();
  data.contact_count = count_.points();
  data.palm_distance_mm = palm_.points();
  for (const TouchLog& log : bodies_) {
    data.bodies.push_back(log.story());
    const auto& touches = log.story().touches;
    data.touches.insert(data.touches.end(), touches.begin(), touches.end());
  }
  std::stable_sort(data.touches.begin(), data.touches.end(),
                   [](const Touch& a, const Touch& b) { return a.from_s < b.from_s; });
  data.summary = statistics_.snapshot();
  data.cpu_time = data.meta.simulated_clock || data.summary.wall.max_ns <= 0.0;
  data.durations = data.cpu_time ? cpu_ : wall_;
  data.missing_ticks = missing_ticks_;
  data.emergency_stop_s = emergency_stop_s_;
  data.largest_contact_force_n = largest_force_n_;
  data.largest_contact = largest_;
  data.damped_share =
      records_ > 0 ? static_cast<double>(damped_) / static_cast<double>(records_) : 0.0;
}

/// The value of `key = "value"` at the start of a line of a TOML text; empty when there is none.
std::string tomlText(const std::string& text, const std::string& key) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (!startsWith(line, key.c_str())) continue;
    const std::size_t equals = line.find_first_not_of(" \t", key.size());
    if (equals == std::string::npos || line[equals] != '=') continue;
    const std::size_t open = line.find('"', equals);
    const std::size_t close = open == std::string::npos ? open : line.find('"', open + 1);
    if (close != std::string::npos) return line.substr(open + 1, close - open - 1);
  }
  return {};
}

}  // namespace

std::string embeddedName(const RecordingMeta& meta, const std::string& kind) {
  for (const auto& [name, text] : meta.files) {
    if (tomlText(text, "kind") == kind) return tomlText(text, "name");
  }
  return {};
}

Expected<ReportData> collectReport(const std::string& recording_path, int columns,
                                   const std::function<void(double)>& progress) {
  auto opened = RecordingReader::open(recording_path);
  if (!opened) return opened.errors();
  RecordingReader& reader = **opened;
  TickRecord record;
  if (reader.size() == 0) {
    return Diagnostic{
        recording_path, 0, "", "", "holds no ticks", "record a run that lasts a while"};
  }
  ReportData data;
  data.meta = reader.meta();
  data.path = recording_path;
  for (const std::uint64_t i : {std::uint64_t{0}, reader.size() - 1}) {
    if (!reader.read(i, record)) return unreadable(recording_path, i, reader.size());
    (i == 0 ? data.from_s : data.to_s) = record.time_s;
  }
  data.to_s = std::max(data.to_s, record.time_s) + data.meta.period_s;
  Collector collector(data.meta, data.from_s, data.to_s, columns);
  for (std::uint64_t i = 0; i < reader.size(); ++i) {
    if (!reader.read(i, record)) return unreadable(recording_path, i, reader.size());
    collector.add(record);
    if (progress && (i + 1) % kTicksBetweenProgress == 0) {
      progress(static_cast<double>(i + 1) / static_cast<double>(reader.size()));
    }
  }
  collector.finish(data);
  return data;
}

}  // namespace wholehand
