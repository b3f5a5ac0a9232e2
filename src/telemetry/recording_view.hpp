#pragma once

#include "telemetry/recording.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// The readable part of a recording.
struct ViewedRecording {
  std::unique_ptr<RecordingReader> reader;
  /// Number of the first tick of a damaged end, before which the reader ends; empty: undamaged.
  std::optional<std::uint64_t> unreadable_from_tick;
  std::uint64_t last_tick = 0;  ///< number of the last tick, which may be unreadable
};

/// Datasets that a reader skips, and that may be missing: their numbers stay as in an empty record.
struct LeftOut {
  std::vector<std::string> of_ticks, of_contacts;
};

/// As RecordingReader::open(), but a file with unreadable ticks at its end is read up to them.
/// Refuses black boxes. A file that is being written, or whose writer was killed, is not marked as
/// read, so that a later reader can still tell these two cases apart
/// (RecordingOutline::being_written).
[[nodiscard]] Expected<ViewedRecording> viewRecording(const std::string& path,
                                                      const LeftOut& left_out = {});

/// Ticks of a recording that read() refused.
struct UnreadTicks {
  std::uint64_t count = 0, first = 0;  ///< `first`: the place of the first one
};

/// What of a recording is not shown, and why; empty: all of it is.
[[nodiscard]] Diagnostics notShown(const ViewedRecording& viewed, const UnreadTicks& unread,
                                   const std::string& path);

}  // namespace wholehand
