#include "replay/recording_series.hpp"

#include "replay/series_collector.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace wholehand {

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
