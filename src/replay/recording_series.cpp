#include "replay/recording_series.hpp"

#include "replay/recording_marks.hpp"
#include "replay/series_channels.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little);

/// Of a stretch: a page draws no more, and a flood of them fills no memory.
constexpr std::size_t kMostEvents = 20'000, kMostMarks = 5'000, kMostGaps = 5'000;

/// Smallest and largest value of every channel in every column.
class Extremes {
 public:
  Extremes(std::size_t channels, std::size_t columns)
      : columns_(columns),
        values_(2 * channels * columns, std::numeric_limits<float>::quiet_NaN()) {}

  void add(std::size_t channel, std::size_t column, double value) {
    if (!std::isfinite(value)) return;
    const auto v = static_cast<float>(value);
    float& low = values_[2 * channel * columns_ + column];
    float& high = values_[(2 * channel + 1) * columns_ + column];
    if (!(v >= low)) low = v;
    if (!(v <= high)) high = v;
  }
  [[nodiscard]] std::string bytes() const {
    std::string out(values_.size() * sizeof(float), '\0');
    std::memcpy(out.data(), values_.data(), out.size());
    return out;
  }

 private:
  std::size_t columns_;
  std::vector<float> values_;  ///< of each channel: low of every column, then high
};

class Collector {
 public:
  Collector(const RecordingMeta& meta, const SeriesQuestion& question)
      : meta_(meta),
        question_(question),
        channels_(seriesChannels(meta)),
        values_(channels_.size()),
        extremes_(channels_.size(), static_cast<std::size_t>(question.columns)) {}

  void add(const TickRecord& record, const TickRecord* before);
  void skipUnreadable(double time_s);
  [[nodiscard]] std::string message(std::uint64_t first_tick) const;

 private:
  [[nodiscard]] std::size_t columnOf(double time_s) const;
  bool put(Json& list, std::size_t most, Json item);

  const RecordingMeta& meta_;
  const SeriesQuestion question_;
  const std::vector<SeriesChannel> channels_;
  std::vector<double> values_;
  Extremes extremes_;
  Json events_ = Json::array(), gaps_ = Json::array(), marks_ = Json::array();
  Json unreadable_ = Json::array();
  bool truncated_ = false;
};

std::size_t Collector::columnOf(double time_s) const {
  const double share = (time_s - question_.from_s) / (question_.to_s - question_.from_s);
  return static_cast<std::size_t>(
      std::clamp(std::floor(share * question_.columns), 0.0, question_.columns - 1.0));
}

bool Collector::put(Json& list, std::size_t most, Json item) {
  if (list.size() >= most) {
    truncated_ = true;
    return false;
  }
  list.push_back(std::move(item));
  return true;
}

void Collector::add(const TickRecord& record, const TickRecord* before) {
  fillSeriesValues(record, meta_, values_);
  const std::size_t column = columnOf(record.time_s);
  for (std::size_t c = 0; c < values_.size(); ++c) extremes_.add(c, column, values_[c]);
  for (int e = 0; e < record.exercise.event_count; ++e) {
    const ExerciseEvent& event = record.exercise.events[static_cast<std::size_t>(e)];
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
  put(gaps_, kMostGaps,
      {{"from_s", before->time_s + meta_.period_s}, {"to_s", record.time_s}, {"ticks", missing}});
}

void Collector::skipUnreadable(double time_s) {
  truncated_ = true;
  const double end_s = time_s + meta_.period_s;
  const bool follows = !unreadable_.empty() &&
                       time_s - unreadable_.back()["to_s"].get<double>() < 0.5 * meta_.period_s;
  if (follows) {
    unreadable_.back()["to_s"] = end_s;
  } else {
    put(unreadable_, kMostGaps, {{"from_s", time_s}, {"to_s", end_s}});
  }
}

std::string Collector::message(std::uint64_t first_tick) const {
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
  text.append((4 - text.size() % 4) % 4, ' ');  // the numbers lie where floats may
  const auto bytes = static_cast<std::uint32_t>(text.size());
  std::string out(sizeof bytes, '\0');
  std::memcpy(out.data(), &bytes, sizeof bytes);
  return out + text + extremes_.bytes();
}

}  // namespace

std::uint64_t firstTickAt(const RecordingReader& recording, double time_s) {
  const std::vector<std::uint64_t>& numbers = recording.outline().numbers;
  const double period_s = recording.meta().period_s;
  const auto at = std::partition_point(numbers.begin(), numbers.end(), [&](std::uint64_t tick) {
    return static_cast<double>(tick) * period_s < time_s;
  });
  return static_cast<std::uint64_t>(at - numbers.begin());
}

std::string seriesMessage(RecordingReader& recording, const SeriesQuestion& question) {
  Collector collector(recording.meta(), question);
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
