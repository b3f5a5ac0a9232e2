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

/// Datasets that a reader of plots skips: their numbers stay as in an empty record.
struct LeftOut {
  std::vector<std::string> of_ticks, of_contacts;
};

/// As RecordingReader::open(), but a file with unreadable ticks at its end is read up to them.
/// Refuses black boxes. A file that is being written, or whose writer was killed, is not marked as
/// read, so that a later reader can still tell these two cases apart
/// (RecordingOutline::being_written).
/// @param chunks_at_once quarters of a second read around a tick: 1 for random access, more for
/// sequential reading
[[nodiscard]] Expected<ViewedRecording> viewRecording(const std::string& path,
                                                      std::uint64_t chunks_at_once,
                                                      const LeftOut& left_out = {});

}  // namespace wholehand
