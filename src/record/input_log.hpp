#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"
#include "record/recording.hpp"

#include <array>
#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace wholehand {

/// Faults of a tick that are inputs; all other faults follow from the inputs.
inline constexpr Fault kInputFaults = kOfReading | Fault::kDeviceWrite | Fault::kStopRequested |
                                      Fault::kEmergencyStop | Fault::kGentleStop;

/// All inputs of a tick. The tick can be repeated from them.
struct TickInput {
  AxisPosition q_m;
  std::uint32_t elapsed_periods = 1;
  Fault faults = Fault::kNone;  ///< subset of kInputFaults
  Mover moved_by = Mover::kNobody;
  Help help = Help::kUnspecified;
  std::int32_t command_count = 0;
  std::array<Command, kMaxCommands> commands{};
};

/// Largest entry of a tick in the log [bytes].
inline constexpr std::size_t kMostInputBytes = 3072;

/// State that writer and reader of the log maintain: last position of each axis in encoder counts,
/// and the mover.
struct InputLogState {
  AxisPosition encoder_step;  ///< [m or rad]; 0: the axis has no encoder step
  std::array<std::int64_t, kMaxAxes> counts{};
  Mover moved_by = Mover::kNobody;
  Help help = Help::kUnspecified;
};
/// State at the beginning of a recording's log.
[[nodiscard]] InputLogState inputLogOf(const RecordingMeta& meta);

/// Writes a tick's inputs losslessly and returns the bytes written: one byte if nothing moved, else
/// one more for each axis, or eight for an axis that is not at a whole count. Real-time safe.
/// @pre q_m has the axes of state.encoder_step; out has room for kMostInputBytes
WHOLEHAND_RT std::size_t logInput(InputLogState& state, const TickRecord& record,
                                  std::byte* out) noexcept;

/// Reads a tick's inputs. Returns the bytes read; 0 when they are damaged.
[[nodiscard]] std::size_t readInput(InputLogState& state, const std::byte* in, std::size_t bytes,
                                    TickInput& input);

/// Journal of the inputs of a recording that is being written, synced to the disk every second. A
/// power cut may leave the recording itself unreadable, because HDF5 does not order writes between
/// two syncs. The recording can then be rebuilt bit-exactly from the journal. The journal is
/// removed when the recording is complete and on the disk. See docs/recording.md. Not real-time
/// safe.
class InputJournal {
 public:
  /// "run.h5" -> "run.inputs"
  [[nodiscard]] static std::string pathOf(const std::string& recording);

  /// Creates the file. Replaces an existing file only if it is a journal.
  /// @return the error, or an empty text
  [[nodiscard]] static std::string create(const std::string& path, const RecordingMeta& meta,
                                          std::unique_ptr<InputJournal>& journal);
  ~InputJournal();
  InputJournal(const InputJournal&) = delete;
  InputJournal& operator=(const InputJournal&) = delete;

  /// Appends the inputs of a tick. After a failed write or a missing tick nothing more is appended,
  /// because a run repeated from inputs with a gap would differ from the real one.
  void append(const TickRecord& record);
  /// Writes and syncs the appended inputs.
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
  std::size_t ticks_ = 0;  ///< number of ticks in `waiting_`
  std::optional<std::uint64_t> last_tick_;
  bool broken_ = false;
  std::mutex mutex_;
  std::condition_variable ends_;
  bool ending_ = false;  ///< guarded by mutex_
  std::atomic<bool> dirty_{false};
  std::thread
      syncing_;  ///< syncs in its own thread, so that a slow disk does not delay the recorder
};

/// Reads a journal up to its first damaged block.
class InputJournalReader {
 public:
  [[nodiscard]] static bool isJournal(const std::string& path);
  [[nodiscard]] static Expected<std::unique_ptr<InputJournalReader>> open(const std::string& path);

  [[nodiscard]] const RecordingMeta& meta() const noexcept { return meta_; }
  /// Reads the next tick's inputs. Returns false at the end.
  [[nodiscard]] bool next(TickInput& input);

 private:
  RecordingMeta meta_;
  std::vector<std::byte> inputs_;  ///< inputs of all undamaged blocks
  std::size_t at_ = 0;
  InputLogState log_;
};

}  // namespace wholehand
