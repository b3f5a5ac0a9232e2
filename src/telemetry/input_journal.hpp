#pragma once

#include "core/expected.hpp"
#include "telemetry/input_log.hpp"
#include "telemetry/recording.hpp"

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace wholehand {

/// The inputs of a recording that is being written, synced to the disk every second. A power cut
/// may leave the recording itself unreadable, since HDF5 orders no write between two syncs; by its
/// inputs it is made again, to the bit. Removed when the recording is complete and on the disk.
/// docs/recording.md. Not for the tick.
class InputJournal {
 public:
  /// "run.h5" -> "run.inputs"
  [[nodiscard]] static std::string pathOf(const std::string& recording);

  /// Creates the file. Replaces an older journal, nothing else.
  /// @return what went wrong, or an empty text
  [[nodiscard]] static std::string create(const std::string& path, const RecordingMeta& meta,
                                          std::unique_ptr<InputJournal>& journal);
  ~InputJournal();
  InputJournal(const InputJournal&) = delete;
  InputJournal& operator=(const InputJournal&) = delete;

  /// Keeps the inputs of a tick. After a failed write nothing more is kept, for a journal with a
  /// gap is of no use.
  void append(const TickRecord& record);
  /// Writes and syncs what was appended.
  void flush();
  /// Removes the file.
  void remove();

 private:
  InputJournal(std::string path, int file, const RecordingMeta& meta);
  void write();
  void syncNowAndThen();

  const std::string path_;
  const int file_;
  InputLogState log_;
  std::vector<std::byte> waiting_;
  std::size_t ticks_ = 0;  ///< in `waiting_`
  bool broken_ = false;
  std::mutex mutex_;
  std::condition_variable ends_;
  bool ending_ = false;  ///< guarded by mutex_
  std::atomic<bool> dirty_{false};
  std::thread syncing_;  ///< a slow disk must not delay the recorder
};

/// Reads a journal as far as it is whole.
class InputJournalReader {
 public:
  [[nodiscard]] static bool isJournal(const std::string& path);
  [[nodiscard]] static Expected<std::unique_ptr<InputJournalReader>> open(const std::string& path);

  [[nodiscard]] const RecordingMeta& meta() const noexcept { return meta_; }
  /// The next tick's inputs. False at the end.
  [[nodiscard]] bool next(TickInput& input);

 private:
  RecordingMeta meta_;
  std::vector<std::byte> inputs_;  ///< of all whole blocks
  std::size_t at_ = 0;
  InputLogState log_;
};

}  // namespace wholehand
