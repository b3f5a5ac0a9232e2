#pragma once

#include "loop/runtime/session.hpp"
#include "loop/runtime/statistics.hpp"
#include "record/black_box.hpp"
#include "record/hub.hpp"
#include "record/recording.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace wholehand {

/// A result of the exercise.
struct ResultValue {
  std::string name;    ///< name of the value, with its unit
  double value = 0.0;  ///< in that unit, from the exercise's last tick
  std::string shown;   ///< text for a person: "Spilt 2 ml"
};

/// Results that the exercise's panel names; empty if no tick had values. Not real-time safe.
[[nodiscard]] std::vector<ResultValue> exerciseResults(const Models& models,
                                                       const TickSummary& summary);

/// Options of a run.
struct RunPlan {
  std::string title;
  std::string profile;  ///< code of the person whose profile is open; empty: none
  std::uint64_t visit = 0, visit_item = 0;  ///< visit and item in the clinic's records; 0: none
  std::uint64_t seed = 0;                   ///< stored in the recording
  std::uint64_t duration_ticks = 0;         ///< 0: until stopped
  std::string record;                       ///< HDF5 file; empty: none
  std::string
      black_box;  ///< black box file, written on a fault (blackBoxPath()); empty: no black box
  bool simulated_clock = false;
  /// If true, the run refuses to begin when the machine grants no real-time priority or locked
  /// memory. Set it for a device that moves a person.
  bool real_time_required = false;
  std::optional<RehearsalPassed> rehearsed;  ///< for HapticRenderer::prepare()
  std::shared_ptr<StartPermit> permit;  ///< judged in the first tick (SessionConfig); null: none
  /// Queue capacity; records beyond it are dropped.
  std::size_t queue_bytes = SessionConfig{}.queue_bytes;
  /// Functions that receive every record, outside the real-time thread; on the simulated clock in
  /// the calling thread.
  std::vector<std::function<void(const TickRecord&)>> sinks;
  /// Signals that stop the run gracefully (loop/runtime/interrupt_scope.hpp); null: none.
  Interrupts* interrupts = nullptr;
  /// Counts allocations of the calling thread (loop/realtime/allocation_counter.hpp); null: not
  /// counted.
  std::uint64_t (*count_allocations)() noexcept = nullptr;
  /// Called often by runAndRecord() with the progress; may be null.
  std::function<void(const TickSummary&, double rate_hz)> status;
  /// Called by runAndRecord() with messages for a person during the run; may be null.
  std::function<void(const std::string& sentence)> notice;
};

/// Result of a run.
struct RunOutcome {
  TickSummary summary;   ///< ticks, missed deadlines and faults as counted by the real-time side
  std::string exercise;  ///< empty: none
  int level = 0;
  std::vector<ResultValue> results;
  SessionCounters counters;
  std::uint64_t dropped_records = 0;  ///< dropped because the queue was full
  std::uint64_t dropped_writes = 0;   ///< dropped because the disk was full or the recorder failed
  std::uint64_t written = 0;          ///< number of ticks in the recording
  SetupReport setup;                  ///< settings granted to the real-time thread
  /// Messages about consumers that threw and were switched off, and about a removed recording.
  std::vector<std::string> failures;
  std::string black_box;     ///< one line about the black box file; empty: not needed
  std::string engine;        ///< engine of the world
  bool uncertified = false;  ///< gains that the stability check refused were allowed
  bool interrupted = false;  ///< stopped by a signal
  bool faulted = false;
};

/// One run of a rig, from arming to closed files: session, statistics, recording and black box.
/// Every run of the program uses this class, with any device and clock.
///
/// Opening order: open the device, create black box and recording, enable the device. Steps that
/// wait for a disk are done before the device outputs any effort. Closing order: ramp to the
/// neutral effort, close the device, write the black box, close the recording. The device is closed
/// before anything waits for a disk.
class Run {
 public:
  /// Prepares the renderer and creates recording and black box. The device is not enabled yet, but
  /// a stop that is requested from now on takes effect. On an error the device is closed.
  [[nodiscard]] static Expected<std::unique_ptr<Run>> prepare(std::shared_ptr<Rig> rig,
                                                              RunPlan plan);
  /// If the run is still active, ramps to neutral first.
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Arms the rig and starts the loop in real time on its own thread. Call once.
  [[nodiscard]] Expected<Done> begin();
  /// Arms the rig and ticks in the calling thread as fast as possible until the end. Call once.
  [[nodiscard]] Expected<Done> simulate();

  // Callable from any thread, one at a time.
  [[nodiscard]] bool tryCommand(const Command& command) { return session_->tryCommand(command); }
  [[nodiscard]] std::size_t waitingCommands() const { return session_->waitingCommands(); }
  // Callable from any thread.
  void requestStop() noexcept { session_->requestStop(); }
  void requestGentleStop() noexcept { session_->requestGentleStop(); }
  void requestEmergencyStop() noexcept { session_->requestEmergencyStop(); }
  void setHolderAlive(bool alive) noexcept { session_->setHolderAlive(alive); }
  void setParameter(int index, double value) noexcept { session_->setParameter(index, value); }
  [[nodiscard]] bool running() const { return session_->running(); }
  [[nodiscard]] LoopWord word() const noexcept { return session_->word(); }
  [[nodiscard]] TickSummary summary() const { return statistics_.snapshot(); }
  /// Number of ticks missing in the recording because the queue of the loop, the recorder's thread
  /// or the disk had no room.
  [[nodiscard]] std::uint64_t droppedRecords() const {
    return session_->droppedRecords() + hub_->unrecorded() + (writer_ ? writer_->dropped() : 0);
  }
  /// Size of the recording written so far; no disk access.
  [[nodiscard]] std::uint64_t recordedBytes() const { return writer_ ? writer_->bytes() : 0; }
  /// Settings granted to the loop. Valid after begin().
  [[nodiscard]] const SetupReport& setup() const { return setup_; }
  [[nodiscard]] const Rig& rig() const { return *rig_; }

  /// Waits for the end and closes everything. A recording without ticks is removed. Idempotent.
  void finish();
  /// Result of the run. Valid after finish().
  [[nodiscard]] RunOutcome outcome() const;

 private:
  Run(std::shared_ptr<Rig> rig, RunPlan plan) : rig_(std::move(rig)), plan_(std::move(plan)) {}
  [[nodiscard]] Expected<Done> keepTrack();
  void startSession();
  void closeRecording();

  std::shared_ptr<Rig> rig_;  ///< declared before its users
  RunPlan plan_;
  std::unique_ptr<RecordingWriter> writer_;
  std::unique_ptr<BlackBox> black_box_;  ///< outlives the session
  TickStatistics statistics_;
  std::unique_ptr<Session> session_;
  std::unique_ptr<TelemetryHub> hub_;
  SetupReport setup_;
  std::string black_box_said_;
  std::vector<std::string> failures_;
  bool finished_ = false;
};

/// Message that the recording has been refused by the disk since this time of the run.
[[nodiscard]] std::string lossNotice(double time_s, const std::string& record);

/// Replaces the counters in a summary of records by the exact counters of the real-time side. A
/// full queue drops records, but not counts.
[[nodiscard]] TickSummary corrected(TickSummary summary, const SessionCounters& counted,
                                    double period_s);

/// Runs the rig until its duration ends, a fault occurs or a signal arrives, and closes everything
/// in any case. If the run does not begin, no recording remains.
[[nodiscard]] Expected<RunOutcome> runAndRecord(Rig& rig, RunPlan plan);

/// Name of the device passport within a recording.
inline constexpr const char* kRecordedPassport = "passport/passport.toml";

/// Adds the device's axes without armed_position.
void describeAxes(const DeviceModel& device, RecordingMeta& meta);

/// Metadata of a recording of this rig.
[[nodiscard]] Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                                        std::uint64_t seed, bool simulated_clock);

/// Path of a run's black box file. With a recording it has the recording's path with another
/// extension ("run.h5" → "run.wbb"). Without one it is out/blackbox/<time>-<8 random digits>.wbb,
/// or in the folder for temporary files if the working directory is not writable.
[[nodiscard]] std::string blackBoxPath(const std::string& recording);

/// Arms the black box of an armed rig.
[[nodiscard]] Expected<std::unique_ptr<BlackBox>> armBlackBox(const Rig& rig,
                                                              const RecordingMeta& meta,
                                                              const std::string& path,
                                                              std::uint64_t most_ticks);

/// Writes the black box file after a stopping fault or an emergency stop. Returns one line about
/// it, or an empty text if none was needed. Call it after the run.
[[nodiscard]] std::string writeBlackBoxIfNeeded(BlackBox& box);

}  // namespace wholehand
