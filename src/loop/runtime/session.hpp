#pragma once

#include "loop/core/command.hpp"
#include "loop/core/tick_record.hpp"
#include "loop/realtime/periodic_thread.hpp"
#include "loop/realtime/spsc_queue.hpp"
#include "loop/realtime/stage_clock.hpp"
#include "loop/renderer/haptic_renderer.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "loop/runtime/start_permit.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>

namespace wholehand {

/// Measures each tick: its whole duration by wall and CPU clock, its stages by CPU clock.
class TickTimer final : public StageListener {
 public:
  WHOLEHAND_RT void start() noexcept { clock_.start(); }
  WHOLEHAND_RT void lap(Stage stage) noexcept override { clock_.lap(stage); }
  /// Ends the tick and writes its times into the record.
  WHOLEHAND_RT void finish(TickRecord& record) noexcept {
    const StageTimes times = clock_.finish();
    record.wall_ns = times.wall_ns;
    record.cpu_ns = times.cpu_ns;
    record.stage_cpu_ns = times.stage_cpu_ns;
  }

 private:
  StageClock clock_;
};

struct SessionConfig {
  /// Number of periods until the ramp to neutral begins.
  std::uint64_t duration_ticks = std::numeric_limits<std::uint64_t>::max();
  /// Size of the record queue [bytes]. At 1 kHz it holds 4 s of free motion, or 1.7 s with 10
  /// bodies and 20 contacts. Whoever empties it does not wait for the disk.
  std::size_t queue_bytes = std::size_t{8} << 20U;
  std::size_t queue_commands = 512;   ///< size of the command queue; further commands are refused
  TickListener* listener = nullptr;   ///< outlives the session; may be null
  TickListener* black_box = nullptr;  ///< called last in every tick, when its times are known; may
                                      ///< be null
  /// Checked in every tick: the loop stops gently after a signal. Outlives the session; may be
  /// null.
  Interrupts* interrupts = nullptr;
  /// Judged in the first tick; when it does not hold, that tick begins the ramp to neutral and no
  /// effort is sent. Outlives the session; null: the effort may begin.
  StartPermit* permit = nullptr;
  /// Counts the calling thread's allocations (loop/realtime/allocation_counter.hpp); null: not
  /// counted.
  std::uint64_t (*count_allocations)() noexcept = nullptr;
};

/// Counters of the real-time side; correct even when a full queue dropped records.
struct SessionCounters {
  std::uint64_t ticks_run = 0;  ///< tick() calls
  /// Missed deadlines; ticks_run + skipped_periods is the number of all periods.
  std::uint64_t skipped_periods = 0;
  std::uint64_t allocations = 0;                   ///< allocations inside tick(), if counted
  Fault latched = Fault::kNone;                    ///< faults that stopped the run
  std::array<std::uint64_t, kFaultBits> faults{};  ///< ticks in which each bit was set
  std::uint64_t stopping_faults = 0;               ///< ticks with a fault that stops rendering
};

/// What the loop itself has reported, for other threads. On a simulated clock it reports nothing.
struct LoopWord {
  /// End of the newest tick, or the begin of the first one, CLOCK_MONOTONIC; 0: no tick yet.
  std::int64_t ticked_ns = 0;
  /// The requests that the newest tick obeyed (kStopRequested, kEmergencyStop): the device has
  /// accepted the effort that was computed after them.
  Fault stops = Fault::kNone;
  bool at_neutral = false;  ///< the device has accepted its neutral effort after a stop or a fault
  bool over = false;        ///< no tick follows
};

/// Runs a renderer tick by tick until its duration is over, a stop is requested, or a fault has
/// brought the device to neutral. Every tick puts one record into a queue; a full queue drops the
/// record and counts it, and the tick never waits.
class Session {
 public:
  /// @pre renderer is armed and outlives this
  Session(HapticRenderer& renderer, const SessionConfig& config);
  /// Ramps to neutral first if it still runs, which takes up to 100 ms.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Starts a real-time run: ticks on its own thread at the renderer's period until the end.
  [[nodiscard]] Expected<SetupReport> start(const PeriodicThreadConfig& thread);
  /// True until the last record is in the queue. Any thread, also while start() runs.
  [[nodiscard]] bool running() const;
  void join();
  /// Takes the next record, in order. One consumer.
  [[nodiscard]] bool tryPop(TickRecord& record) noexcept { return queue_.try_pop(record); }

  /// Runs on a simulated clock: ticks in the calling thread as fast as possible and passes each
  /// record to `sink`.
  void runSimulated(const std::function<void(const TickRecord&)>& sink);

  /// Queues a command for one of the next ticks, in order; false when the queue is full. From one
  /// thread at a time. Commands of a simulated run may also come from its sink.
  [[nodiscard]] bool tryCommand(const Command& command) noexcept {
    return commands_.try_push(command);
  }

  /// Sets the target of a live parameter. Only the latest value of each parameter counts, and a
  /// full command queue cannot lose it. A value set before the first tick is in force in it,
  /// without a ramp: the effort limits are the first parameters, so the first tick takes them all.
  /// Ignores unknown indices. Any thread.
  void setParameter(int index, double value) noexcept {
    if (index >= 0 && index < kMaxLiveParameters) wanted_[index].store(value);
  }

  /// Number of commands that wait for the loop; a tick takes at most 8. For the thread that queues
  /// commands it is an upper bound.
  [[nodiscard]] std::size_t waitingCommands() const noexcept { return commands_.size(); }

  /// Requests the ramp to neutral; the session ends when the ramp is done. Any thread, also a
  /// signal handler.
  void requestStop() noexcept { renderer_.requestStop(); }
  /// Requests a gentle stop: like requestStop(), but the effort falls over the exercise's fade-out
  /// time plus the ramp's time. Any thread, also a signal handler.
  void requestGentleStop() noexcept { renderer_.requestGentleStop(); }
  /// Says whether the program or game that shows the exercise is alive. While it is not, the
  /// exercise's effort fades out. Only the latest value counts, and a full command queue cannot
  /// lose it. Any thread.
  void setHolderAlive(bool alive) noexcept { holder_alive_.store(alive); }
  /// Requests an emergency stop: like requestStop(), but the records mark it as an emergency stop.
  /// Any thread, also a signal handler.
  void requestEmergencyStop() noexcept { renderer_.requestEmergencyStop(); }

  /// Any thread.
  [[nodiscard]] LoopWord word() const noexcept {
    const std::int64_t ticked_ns = ticked_ns_.load();
    return {ticked_ns, obeyed_stops_.load(), at_neutral_.load(), over_.load()};
  }

  [[nodiscard]] std::uint64_t droppedRecords() const { return queue_.dropped(); }
  /// Valid after the session has ended.
  [[nodiscard]] SessionCounters counters() const { return counters_; }

 private:
  [[nodiscard]] std::uint64_t allocationsSoFar() const noexcept;
  [[nodiscard]] bool tickOnce(std::uint32_t elapsed_periods, std::int64_t lateness_ns) noexcept;
  void judgePermit() noexcept;
  void noteTime() noexcept;
  void noteTick(bool more) noexcept;
  void followInterrupts() noexcept;
  void takeCommands() noexcept;
  void takeParameters() noexcept;
  void count(std::uint64_t allocations) noexcept;

  HapticRenderer& renderer_;
  const SessionConfig config_;
  RecordQueue queue_;
  SpscQueue<Command> commands_;
  TickTimer timer_;
  TickRecord record_;  ///< the tick's own record, reused
  std::uint64_t next_tick_ = 0;
  bool time_is_over_ = false;
  std::atomic<bool> holder_alive_{true};
  std::array<std::atomic<double>, kMaxLiveParameters> wanted_;  ///< by setParameter(); NaN: none
  std::array<double, kMaxLiveParameters> taken_{};              ///< ticking thread only
  std::atomic<std::int64_t> ticked_ns_{0};  ///< this and the next three: LoopWord
  std::atomic<Fault> obeyed_stops_{Fault::kNone};
  std::atomic<bool> at_neutral_{false}, over_{false};
  bool interrupted_ = false, reported_alive_ = true;  ///< ticking thread only
  SessionCounters counters_;
  std::atomic<bool> has_thread_{false};     ///< thread_ is set and stays; for other threads
  std::unique_ptr<PeriodicThread> thread_;  ///< last member: joined before the data it writes is
                                            ///< destroyed
};

static_assert(std::atomic<std::int64_t>::is_always_lock_free);
static_assert(std::atomic<Fault>::is_always_lock_free);

}  // namespace wholehand
