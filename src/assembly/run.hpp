#pragma once

#include "assembly/exercise_results.hpp"
#include "assembly/rig.hpp"
#include "runtime/session.hpp"
#include "telemetry/black_box.hpp"
#include "telemetry/hub.hpp"
#include "telemetry/recording.hpp"
#include "telemetry/statistics.hpp"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// How a rig is to be run and what is to be kept of it.
struct RunPlan {
  std::string title;
  std::uint64_t seed = 0;            ///< noted in the recording
  std::uint64_t duration_ticks = 0;  ///< 0: until it is stopped
  std::string record;                ///< HDF5 file; empty: none
  std::string black_box;  ///< file that a fault makes (blackBoxPath()); empty: none is armed
  bool simulated_clock = false;
  std::size_t queue_ticks = SessionConfig{}.queue_ticks;  ///< records that wait; more are dropped
  /// Each sees every record, off the real-time thread; on the simulated clock in the calling one.
  std::vector<std::function<void(const TickRecord&)>> sinks;
  /// Signals that stop the run gently (runtime/interrupt_scope.hpp); null: none do.
  Interrupts* interrupts = nullptr;
  /// Allocations of the calling thread so far (realtime/allocation_counter.hpp); null: not counted.
  std::uint64_t (*count_allocations)() noexcept = nullptr;
  /// runAndRecord() tells it how it goes, often; may be null.
  std::function<void(const TickSummary&, double rate_hz)> status;
  /// runAndRecord() tells it, while it runs, what a person should know; may be null.
  std::function<void(const std::string& sentence)> notice;
};

/// What came of it.
struct RunOutcome {
  TickSummary summary;   ///< its ticks, missed deadlines and faults are the real-time side's
  std::string exercise;  ///< empty: none
  int level = 0;
  std::vector<ResultValue> results;
  SessionCounters counters;
  std::uint64_t dropped_records = 0;  ///< the queue was full
  std::uint64_t dropped_writes = 0;   ///< the disk was full, or the recorder failed
  std::uint64_t written = 0;          ///< ticks in the recording
  SetupReport setup;                  ///< what the machine granted the real-time thread
  /// Consumers that threw and were switched off, and a recording that was removed, in words.
  std::vector<std::string> failures;
  std::string black_box;     ///< what to do with it, in one line; empty: none was needed
  std::string engine;        ///< that the world was of
  bool uncertified = false;  ///< gains that the stability check refused were allowed
  bool interrupted = false;  ///< by a signal
  bool faulted = false;
};

/// One run of an armed rig, from its first tick to closed files: session, statistics, recording and
/// black box. Every run of the program is one, whatever its device and its clock.
///
/// It closes in one order: the device is brought to its neutral effort, the device is closed, the
/// black box is kept, the recording is closed. No disk is waited for before the device is closed.
class Run {
 public:
  /// Makes recording and black box. Nothing ticks yet; a stop that is asked for from here on holds.
  /// Where it is refused the rig is disarmed and its device closed.
  /// @pre the rig's renderer is armed
  [[nodiscard]] static Expected<std::unique_ptr<Run>> prepare(std::shared_ptr<Rig> rig,
                                                              RunPlan plan);
  /// Where it still runs: ramps to neutral first.
  ~Run();
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /// Starts the loop, in real time on a thread of its own. Once.
  [[nodiscard]] Expected<Done> begin();
  /// Ticks in the calling thread as fast as it goes, until the end. Once.
  void simulate();

  // Any one thread at a time.
  [[nodiscard]] bool tryCommand(const Command& command) { return session_->tryCommand(command); }
  // Any thread.
  void requestStop() noexcept { session_->requestStop(); }
  void requestGentleStop() noexcept { session_->requestGentleStop(); }
  void requestEmergencyStop() noexcept { session_->requestEmergencyStop(); }
  void setOwnerAlive(bool alive) noexcept { session_->setOwnerAlive(alive); }
  [[nodiscard]] bool running() const { return session_->running(); }
  [[nodiscard]] TickSummary summary() const { return statistics_.snapshot(); }
  /// Ticks that no recording holds: the loop, the recorder's thread or the disk had no room.
  [[nodiscard]] std::uint64_t droppedRecords() const {
    return session_->droppedRecords() + hub_->unrecorded() + (writer_ ? writer_->dropped() : 0);
  }
  /// Of the recording's file, as far as it is written; asks no disk.
  [[nodiscard]] std::uint64_t recordedBytes() const { return writer_ ? writer_->bytes() : 0; }
  /// What the machine granted the loop. Valid after begin().
  [[nodiscard]] const SetupReport& setup() const { return setup_; }
  [[nodiscard]] const Rig& rig() const { return *rig_; }

  /// Waits for the end and closes everything; a recording of no tick is removed. Idempotent.
  void finish();
  /// What came of it. Valid after finish().
  [[nodiscard]] RunOutcome outcome() const;

 private:
  Run(std::shared_ptr<Rig> rig, RunPlan plan) : rig_(std::move(rig)), plan_(std::move(plan)) {}
  [[nodiscard]] Expected<Done> keepTrack();
  void startSession();
  void closeRecording();

  std::shared_ptr<Rig> rig_;  ///< before what ticks it
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

/// That the disk refuses a recording, from this time of the run on.
[[nodiscard]] std::string lossNotice(double time_s, const std::string& record);

/// A summary of records with what the real-time side has counted itself: a full queue drops
/// records, never a count.
[[nodiscard]] TickSummary corrected(TickSummary summary, const SessionCounters& counted,
                                    double period_s);

/// Runs the rig to the end of its time, a fault or a signal, and closes everything, whatever
/// happens; without a run there is no recording.
/// @pre the rig's renderer is armed
[[nodiscard]] Expected<RunOutcome> runAndRecord(Rig& rig, RunPlan plan);

}  // namespace wholehand
