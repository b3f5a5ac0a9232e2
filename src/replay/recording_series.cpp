#include "replay/recording_series.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace wholehand {

namespace {

constexpr std::array<std::pair<Fault, const char*>, 3> kRequests = {
    {{Fault::kStopRequested, "stop"},
     {Fault::kEmergencyStop, "emergency_stop"},
     {Fault::kHolderSilent, "controls_lost"}}};

Fault without(Fault bits, Fault gone) {
  return static_cast<Fault>(static_cast<std::uint32_t>(bits) & ~static_cast<std::uint32_t>(gone));
}

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

double contactForce_n(const TickRecord& record) {
  double sum_n = 0.0;
  for (int i = 0; i < record.contact_count; ++i) {
    sum_n += record.contacts[i].force_n.eigen().norm();
  }
  return sum_n;
}

/// Duration of a tick: wall-clock time, or CPU time on a simulated clock.
double duration_s(const TickRecord& record, const RecordingMeta& meta) {
  const bool wall = !meta.simulated_clock && record.wall_ns > 0;
  const std::int64_t duration_ns = wall ? record.wall_ns : record.cpu_ns;
  return duration_ns > 0 ? 1e-9 * static_cast<double>(duration_ns) : kNothing;
}

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little);

/// Limits per interval. A page draws no more, and a corrupt recording cannot exhaust memory.
constexpr std::size_t kMostEvents = 20'000, kMostMarks = 5'000, kMostSeriesGaps = 5'000;

}  // namespace

std::vector<RecordingMark> marksOf(const TickRecord& record, const TickRecord* before,
                                   const RecordingMeta& meta) {
  std::vector<RecordingMark> marks;
  const auto mark = [&](const char* kind, std::string text = {}, std::string axis = {}) {
    marks.push_back({record.time_s, kind, std::move(text), std::move(axis)});
  };
  const Fault begun = without(record.faults, before != nullptr ? before->faults : Fault::kNone);
  const SafetyState was = before != nullptr ? before->safety_state : SafetyState::kDisarmed;
  const bool is_armed =
      record.safety_state == SafetyState::kArmed || record.safety_state == SafetyState::kRendering;
  const bool was_armed = was == SafetyState::kArmed || was == SafetyState::kRendering;
  if (is_armed && !was_armed) mark("armed");
  for (const auto& [bit, kind] : kRequests) {
    if (any(begun & bit)) mark(kind);
  }
  if (const Fault stopping = begun & kStoppingFaults; any(stopping)) {
    const auto axis = static_cast<std::size_t>(record.fault_axis);
    mark("fault", faultNames(stopping),
         axis < meta.axis_names.size() ? meta.axis_names[axis] : std::string());
  }
  if (before != nullptr && before->authority > 0.0 && !(record.authority > 0.0)) mark("neutral");
  return marks;
}

std::vector<SeriesChannel> seriesChannels(const RecordingMeta& meta) {
  std::vector<SeriesChannel> channels;
  const auto axes = static_cast<int>(meta.axis_names.size());
  for (const char* name :
       {"q_m", "q_s", "intention", "sent", "exercise_effort", "damping", "phi"}) {
    for (int a = 0; a < axes; ++a) channels.push_back({name, a});
  }
  for (const char* name :
       {"alpha", "palm_target_distance_m", "contact_force_n", "contact_count", "duration_s"}) {
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
  const double to_target_m = record.palm_body < 0 ? kNothing : record.palm_target_distance_m;
  for (const double value : {record.exercise.alpha, to_target_m, contactForce_n(record),
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
           "coupling_error_rad", "bodies", "effort_limit", "tank", "palm_distance_m", "parameters"},
          {"capsule", "link", "body", "point_m", "normal", "torque_nm", "distance_m"}};
}

Extremes::Extremes(std::size_t channels, std::size_t columns)
    : columns_(columns), values_(2 * channels * columns, std::numeric_limits<float>::quiet_NaN()) {}

void Extremes::add(std::size_t channel, std::size_t column, double value) {
  if (!std::isfinite(value)) return;
  const auto v = static_cast<float>(value);
  float& low = values_[2 * channel * columns_ + column];
  float& high = values_[(2 * channel + 1) * columns_ + column];
  if (!(v >= low)) low = v;
  if (!(v <= high)) high = v;
}

std::string Extremes::bytes() const {
  std::string out(values_.size() * sizeof(float), '\0');
  std::memcpy(out.data(), values_.data(), out.size());
  return out;
}

SeriesCollector::SeriesCollector(const RecordingMeta& meta, const SeriesQuestion& question)
    : meta_(meta),
      question_(question),
      channels_(seriesChannels(meta)),
      values_(channels_.size()),
      extremes_(channels_.size(), static_cast<std::size_t>(question.columns)) {}

std::size_t SeriesCollector::columnOf(double time_s) const {
  const double share = (time_s - question_.from_s) / (question_.to_s - question_.from_s);
  const double column = std::floor(share * question_.columns);
  // The negated comparison also catches NaN, the share of an interval without length: ticks
  // numbered beyond 2^53 have equal times.
  if (!(column > 0.0)) return 0;
  return static_cast<std::size_t>(std::min(column, question_.columns - 1.0));
}

bool SeriesCollector::put(Json& list, std::size_t most, Json item) {
  if (list.size() >= most) {
    truncated_ = true;
    return false;
  }
  list.push_back(std::move(item));
  return true;
}

void SeriesCollector::add(const TickRecord& record, const TickRecord* before) {
  fillSeriesValues(record, meta_, values_);
  const std::size_t column = columnOf(record.time_s);
  for (std::size_t c = 0; c < values_.size(); ++c) extremes_.add(c, column, values_[c]);
  for (int e = 0; e < record.exercise.event_count; ++e) {
    const ExerciseEvent& event = record.exercise.events[e];
    put(events_, kMostEvents,
        {{"time_s", record.time_s},
         {"type", event.type},
         {"index", event.index},
         {"value", event.value}});
  }
  for (const RecordingMark& mark : marksOf(record, before, meta_)) {
    put(marks_, kMostMarks,
        {{"time_s", mark.time_s}, {"kind", mark.kind}, {"text", mark.text}, {"axis", mark.axis}});
  }
  if (before == nullptr) return;
  const std::uint64_t missing = missingBetween(before->tick, record.tick, record.elapsed_periods);
  if (missing == 0) return;
  put(gaps_, kMostSeriesGaps,
      {{"from_s", before->time_s + meta_.period_s}, {"to_s", record.time_s}, {"ticks", missing}});
}

void SeriesCollector::skipUnreadable(double time_s) {
  truncated_ = true;
  const double end_s = time_s + meta_.period_s;
  const bool follows = !unreadable_.empty() &&
                       time_s - unreadable_.back()["to_s"].get<double>() < 0.5 * meta_.period_s;
  if (follows) {
    unreadable_.back()["to_s"] = end_s;
  } else {
    put(unreadable_, kMostSeriesGaps, {{"from_s", time_s}, {"to_s", end_s}});
  }
}

std::string SeriesCollector::message(std::uint64_t first_tick) const {
  Json channels = Json::array();
  for (const SeriesChannel& channel : channels_) {
    channels.push_back({{"name", channel.name}, {"axis", channel.axis}});
  }
  const Json header = {{"from_s", question_.from_s},
                       {"to_s", question_.to_s},
                       {"columns", question_.columns},
                       {"first_tick", first_tick},
                       {"channels", channels},
                       {"events", events_},
                       {"gaps", gaps_},
                       {"marks", marks_},
                       {"unreadable", unreadable_},
                       {"truncated", truncated_}};
  std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
  text.append((4 - text.size() % 4) % 4, ' ');  // aligns the floats that follow
  const auto bytes = static_cast<std::uint32_t>(text.size());
  std::string out(sizeof bytes, '\0');
  std::memcpy(out.data(), &bytes, sizeof bytes);
  return out + text + extremes_.bytes();
}

std::uint64_t firstTickAt(const RecordingReader& recording, double time_s) {
  const std::vector<std::uint64_t>& numbers = recording.outline().numbers;
  const double period_s = recording.meta().period_s;
  const auto at = std::partition_point(numbers.begin(), numbers.end(), [&](std::uint64_t tick) {
    return static_cast<double>(tick) * period_s < time_s;
  });
  return static_cast<std::uint64_t>(at - numbers.begin());
}

std::string seriesMessage(RecordingReader& recording, const SeriesQuestion& question) {
  SeriesCollector collector(recording.meta(), question);
  const std::uint64_t first = firstTickAt(recording, question.from_s);
  const std::uint64_t end = firstTickAt(recording, question.to_s);
  std::array<TickRecord, 2> records;
  TickRecord *record = &records[0], *before = &records[1];
  bool known = first > 0 && first < end && recording.read(first - 1, *before);
  for (std::uint64_t i = first; i < end; ++i) {
    if (!recording.read(i, *record)) {
      collector.skipUnreadable(static_cast<double>(recording.outline().numbers[i]) *
                               recording.meta().period_s);
      known = false;
      continue;
    }
    collector.add(*record, known ? before : nullptr);
    std::swap(record, before);
    known = true;
  }
  return collector.message(first);
}

}  // namespace wholehand
