#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_view.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// A line of a plot.
struct SeriesChannel {
  std::string name;
  int axis = 0;  ///< of the device; of the exercise's values where the name is "value"
};

/// What is drawn of a recording, in order.
[[nodiscard]] std::vector<SeriesChannel> seriesChannels(const RecordingMeta& meta);

/// The channels' values in a tick, in SI units; NaN where it has none.
/// @pre values has one element for each of seriesChannels(meta)
void fillSeriesValues(const TickRecord& record, const RecordingMeta& meta,
                      std::vector<double>& values);

/// What of a recording neither a channel nor a mark is made of, and no other dataset is packed by:
/// most of the work of reading it.
[[nodiscard]] LeftOut leftOutOfSeries();

}  // namespace wholehand
