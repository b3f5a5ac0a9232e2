#pragma once

#include "core/tick_record.hpp"
#include "telemetry/disk_reserve.hpp"
#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_layout.hpp"
#include "telemetry/table_writer.hpp"

#include <cstdint>
#include <string>

namespace wholehand::recording {

/// One HDF5 file of a recording, with its buffered rows. Not for the tick. Private to telemetry.
class RecordingFile {
 public:
  enum class Written { kAll, kNoRoom, kRefused };

  explicit RecordingFile(const RecordingMeta& meta);

  /// Creates the file with everything except ticks, then replaces an older one. Returns the error,
  /// or an empty text.
  std::string create(const std::string& path, const RecordingMeta& meta);
  /// Buffers a tick until the next write().
  void push(const TickRecord& record);
  /// Writes the buffered rows to disk, or keeps them. After kRefused, HDF5's state of this file is
  /// unreliable: another file must continue.
  [[nodiscard]] Written write();
  /// Takes over the buffered rows of `before` as the first rows of this file.
  void takeRowsOf(RecordingFile& before);
  /// Closes the file; buffered rows are lost.
  void end();

  [[nodiscard]] std::uint64_t written() const noexcept { return ticks_.written(); }
  [[nodiscard]] std::uint64_t pending() const noexcept { return ticks_.pending(); }
  [[nodiscard]] bool atChunkEnd() const noexcept { return ticks_.atChunkEnd(); }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// False when the file was removed meanwhile.
  [[nodiscard]] bool hasName() const { return reserve_.hasName(); }

 private:
  std::string createAt(const std::string& path, const RecordingMeta& meta);
  [[nodiscard]] bool claimRoom();
  void noteBytes();

  DiskReserve reserve_;
  hdf5::Handle file_;
  TableWriter<TickRecord> ticks_;
  TableWriter<ContactRow> contacts_;
  TableWriter<EventRow> events_;
  TableWriter<CommandRow> commands_;
  std::uint64_t bytes_ = 0;
};

}  // namespace wholehand::recording
