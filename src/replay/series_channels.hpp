#pragma once

#include "core/tick_record.hpp"
#include "telemetry/recording.hpp"

#include <string>
#include <vector>

namespace wholehand {

/// One line of a plot.
struct SeriesChannel {
  std::string name;
  int axis = 0;  ///< device axis; for the name "value", index of the exercise's value
};

/// The plotted channels of a recording, in order.
[[nodiscard]] std::vector<SeriesChannel> seriesChannels(const RecordingMeta& meta);

/// Fills the channels' values of a tick, in SI units; NaN where a tick has none.
/// @pre values has one element for each of seriesChannels(meta)
void fillSeriesValues(const TickRecord& record, const RecordingMeta& meta,
                      std::vector<double>& values);

/// Datasets that no channel, mark or other dataset's prediction needs. Reading them is most of the
/// work of reading a recording.
[[nodiscard]] LeftOut leftOutOfSeries();

}  // namespace wholehand
