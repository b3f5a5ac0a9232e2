#pragma once

#include "loop/core/tick_record.hpp"
#include "record/recording.hpp"
#include "replay/replay_question.hpp"

#include <nlohmann/json.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// A notable moment of a recording.
struct RecordingMark {
  double time_s = 0.0;
  std::string kind;  ///< stop, emergency_stop, fault, controls_lost, armed, neutral
  std::string text;  ///< names of the faults; empty for other kinds
  std::string axis;  ///< axis whose limit was exceeded; empty: none
};

/// Marks that begin in a tick.
/// @param before the previous tick of the recording; null for the first
[[nodiscard]] std::vector<RecordingMark> marksOf(const TickRecord& record, const TickRecord* before,
                                                 const RecordingMeta& meta);

/// One line of a plot.
struct SeriesChannel {
  std::string name;
  int axis = 0;  ///< device axis; for the channel "value", index of the exercise's value
};

/// The plotted channels of a recording, in order.
[[nodiscard]] std::vector<SeriesChannel> seriesChannels(const RecordingMeta& meta);

/// Writes the channels' values of a tick, in SI units; NaN where a tick has none.
/// @pre values has one element for each of seriesChannels(meta)
void fillSeriesValues(const TickRecord& record, const RecordingMeta& meta,
                      std::vector<double>& values);

/// Datasets that no channel or mark needs, and from which no other dataset is predicted. Leaving
/// them out saves most of the reading time.
[[nodiscard]] LeftOut leftOutOfSeries();

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
  /// @pre meta and question outlive this object
  SeriesCollector(const RecordingMeta& meta, const SeriesQuestion& question);

  /// Adds a tick.
  /// @param before the previous tick; null when unknown
  void add(const TickRecord& record, const TickRecord* before);
  void skipUnreadable(double time_s);
  /// The message in the layout of replay_question.hpp.
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

/// Extremes of every channel in each column of a time interval, and its events, in the layout of
/// replay_question.hpp. Unreadable ticks are skipped and reported.
[[nodiscard]] std::string seriesMessage(RecordingReader& recording, const SeriesQuestion& question);

/// Index of the recording's first tick at or after a time.
[[nodiscard]] std::uint64_t firstTickAt(const RecordingReader& recording, double time_s);

}  // namespace wholehand
