#include "replay/series_collector.hpp"

#include "replay/recording_marks.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

namespace wholehand {
namespace {

using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little);

/// Limits per interval: a page draws no more, and a flood cannot exhaust memory.
constexpr std::size_t kMostEvents = 20'000, kMostMarks = 5'000, kMostGaps = 5'000;

}  // namespace

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
  // Also of an interval without length, whose share is no number: ticks numbered beyond 2^53 have
  // the same time.
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
  put(gaps_, kMostGaps,
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
    put(unreadable_, kMostGaps, {{"from_s", time_s}, {"to_s", end_s}});
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
  text.append((4 - text.size() % 4) % 4, ' ');  // aligns the following floats
  const auto bytes = static_cast<std::uint32_t>(text.size());
  std::string out(sizeof bytes, '\0');
  std::memcpy(out.data(), &bytes, sizeof bytes);
  return out + text + extremes_.bytes();
}

}  // namespace wholehand
