#pragma once

#include "core/tick_record.hpp"
#include "telemetry/block_index.hpp"
#include "telemetry/disk_reserve.hpp"
#include "telemetry/hdf5_handle.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/recording_layout.hpp"
#include "telemetry/table_writer.hpp"

#include <cstdint>
#include <string>

namespace wholehand::recording {

/// One HDF5 file of a recording, with the rows that are not in it yet. Not for the tick. Private to
/// telemetry.
class RecordingFile {
 public:
  enum class Written { kAll, kNoRoom, kRefused };

  explicit RecordingFile(const RecordingMeta& meta);

  /// Creates the file with everything but ticks; it takes the place of an older one only when that
  /// is done. What went wrong, or nothing.
  std::string create(const std::string& path, const RecordingMeta& meta);
  /// Keeps a tick until the next write().
  void push(const TickRecord& record);
  /// Brings the kept rows to the disk, or keeps them. After kRefused nothing that HDF5 holds of
  /// this file can be relied on: another has to go on.
  [[nodiscard]] Written write();
  /// Takes the rows that `before` keeps, as the first of this one.
  void takeRowsOf(RecordingFile& before);
  /// Closes the file; rows that are kept still are lost.
  void end();

  [[nodiscard]] std::uint64_t written() const noexcept { return ticks_.written(); }
  [[nodiscard]] std::uint64_t pending() const noexcept { return ticks_.pending(); }
  [[nodiscard]] bool atChunkEnd() const noexcept { return ticks_.atChunkEnd(); }
  [[nodiscard]] std::uint64_t bytes() const noexcept { return bytes_; }
  /// False where it was removed meanwhile.
  [[nodiscard]] bool hasName() const { return reserve_.hasName(); }

 private:
  std::string createAt(const std::string& path, const RecordingMeta& meta);
  [[nodiscard]] bool claimRoom();
  void index(const TickRecord& record);
  void noteBytes();

  DiskReserve reserve_;
  hdf5::Handle file_;
  TableWriter<TickRecord> ticks_;
  TableWriter<ContactRow> contacts_;
  TableWriter<EventRow> events_;
  TableWriter<CommandRow> commands_;
  TableWriter<BlockRow> index_;
  BlockIndexer indexer_;
  std::uint64_t bytes_ = 0;
};

}  // namespace wholehand::recording
