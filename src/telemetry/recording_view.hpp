#pragma once

#include "telemetry/recording.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// A recording as far as it can be read.
struct ViewedRecording {
  std::unique_ptr<RecordingReader> reader;
  /// Number of the first tick of a damaged end; the reader ends before it. Empty: it is whole.
  std::optional<std::uint64_t> unreadable_from_tick;
  std::uint64_t last_tick = 0;  ///< number of the last one, which may not be readable
};

/// Datasets that a reader of plots spares: their numbers stay as in an empty record.
struct LeftOut {
  std::vector<std::string> of_ticks, of_contacts;
};

/// As RecordingReader::open(), but a file whose last ticks cannot be read is read up to them. No
/// black boxes. A file that is being written, or whose writer was killed, is not marked as read, so
/// that whoever looks at it later can tell these two apart (RecordingOutline::being_written).
/// @param chunks_at_once quarters of a second that are read around a tick: 1 for moments here and
/// there, more for a reader that goes through them in order
[[nodiscard]] Expected<ViewedRecording> viewRecording(const std::string& path,
                                                      std::uint64_t chunks_at_once,
                                                      const LeftOut& left_out = {});

}  // namespace wholehand
