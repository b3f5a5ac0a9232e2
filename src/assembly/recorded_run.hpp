#pragma once

#include "assembly/interrupt_scope.hpp"
#include "assembly/rig.hpp"
#include "runtime/session.hpp"
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
  std::uint64_t duration_ticks = 0;
  std::uint64_t seed = 0;
  std::string record;     ///< HDF5 file; empty: none
  std::string black_box;  ///< file that a fault makes (blackBoxPath()); empty: none is armed
  bool simulated_clock = false;
  std::size_t queue_ticks = SessionConfig{}.queue_ticks;  ///< records that wait; more are dropped
  std::function<void(const TickSummary&, double rate_hz)> status;  ///< told how it goes, often
  /// Allocations of the calling thread so far (realtime/allocation_counter.hpp); null: not counted.
  std::uint64_t (*count_allocations)() noexcept = nullptr;
  std::function<void(const TickRecord&)> sink;  ///< sees every record, off the real-time thread
  TickListener* listener = nullptr;             ///< told of every tick in the thread that ticks
};

/// What came of it.
struct RunOutcome {
  TickSummary summary;  ///< its ticks, missed deadlines and faults are the real-time side's
  SessionCounters counters;
  std::uint64_t dropped_records = 0;  ///< the queue was full
  std::uint64_t dropped_writes = 0;   ///< the disk was full, or the recorder failed
  std::uint64_t written = 0;          ///< ticks in the recording
  SetupReport setup;                  ///< what the machine granted the real-time thread
  /// Consumers that threw and were switched off, and a recording that was removed, in words.
  std::vector<std::string> failures;
  std::string black_box;     ///< what to do with it, in one line; empty: none was needed
  bool uncertified = false;  ///< gains that the stability check refused were allowed
  bool interrupted = false;  ///< by Ctrl-C
  bool faulted = false;
};

/// A summary of records with what the real-time side has counted itself: a full queue drops
/// records, never a count.
[[nodiscard]] TickSummary corrected(TickSummary summary, const SessionCounters& counted,
                                    double period_s);

/// What a recording of this rig says of itself.
[[nodiscard]] Expected<RecordingMeta> describeRecording(const Rig& rig, const std::string& title,
                                                        std::uint64_t seed, bool simulated_clock);

/// Runs the rig to the end of its time, a fault or Ctrl-C, records it and counts. The device is
/// closed afterwards, whatever happens; without a run there is no recording.
/// While it runs, signals that would end the process or freeze it with the last effort held stop it
/// gently or are ignored (InterruptScope), but for those that the program has inherited as ignored
/// (nohup).
/// @pre the rig's renderer is armed
[[nodiscard]] Expected<RunOutcome> runAndRecord(Rig& rig, const RunPlan& plan);

/// What stopped a run, in words: "device read failed in 1 tick"; "none".
/// @param axes the device's: a fault of an axis then names it
[[nodiscard]] std::string faultText(const TickSummary& summary,
                                    const std::vector<DeviceAxis>& axes = {});
/// What was noticed and stopped nothing: "effort limited in 12 ticks (x 10, finger_flexion 2)";
/// "none".
[[nodiscard]] std::string noticeText(const TickSummary& summary,
                                     const std::vector<DeviceAxis>& axes = {});

}  // namespace wholehand
