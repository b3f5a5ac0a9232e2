#pragma once

#include "core/tick_record.hpp"
#include "replay/replay_question.hpp"
#include "replay/series_channels.hpp"
#include "telemetry/recording.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// Minimum and maximum of every channel in every column.
class Extremes {
 public:
  Extremes(std::size_t channels, std::size_t columns);

  void add(std::size_t channel, std::size_t column, double value);
  [[nodiscard]] std::string bytes() const;

 private:
  std::size_t columns_;
  std::vector<float> values_;  ///< per channel: the minima of all columns, then the maxima
};

/// Collects the ticks of a time interval, in order, into the data of a plot.
class SeriesCollector {
 public:
  /// @pre meta outlives it
  SeriesCollector(const RecordingMeta& meta, const SeriesQuestion& question);

  /// @param before the previous tick; null when unknown
  void add(const TickRecord& record, const TickRecord* before);
  void skipUnreadable(double time_s);
  /// The message in the layout of docs/protocol.md.
  [[nodiscard]] std::string message(std::uint64_t first_tick) const;

 private:
  [[nodiscard]] std::size_t columnOf(double time_s) const;
  bool put(nlohmann::json& list, std::size_t most, nlohmann::json item);

  const RecordingMeta& meta_;
  const SeriesQuestion question_;
  const std::vector<SeriesChannel> channels_;
  std::vector<double> values_;
  Extremes extremes_;
  nlohmann::json events_ = nlohmann::json::array(), gaps_ = nlohmann::json::array(),
                 marks_ = nlohmann::json::array(), unreadable_ = nlohmann::json::array();
  bool truncated_ = false;
};

}  // namespace wholehand
