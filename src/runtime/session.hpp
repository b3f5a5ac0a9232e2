#pragma once

#include "core/command.hpp"
#include "core/tick_listener.hpp"
#include "core/tick_record.hpp"
#include "realtime/periodic_thread.hpp"
#include "realtime/spsc_queue.hpp"
#include "renderer/haptic_renderer.hpp"
#include "runtime/interrupts.hpp"
#include "runtime/tick_timer.hpp"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>

namespace wholehand {

struct SessionConfig {
  std::uint64_t duration_ticks = std::numeric_limits<std::uint64_t>::max();  ///< then ramp down
  std::size_t queue_ticks = 4096;     ///< records the queue holds, four seconds at 1 kHz
  std::size_t queue_commands = 256;   ///< commands that wait; more are refused
  TickListener* listener = nullptr;   ///< outlives the session; may be null
  TickListener* black_box = nullptr;  ///< told last of every tick, its times included; may be null
  double fade_out_s = 0.0;  ///< that the exercise's effort takes, before a gentle stop ramps
  /// The loop looks at it in every tick and stops gently once a signal came; outlives the session;
  /// may be null.
  Interrupts* interrupts = nullptr;
  /// Allocations of the calling thread so far (realtime/allocation_counter.hpp); null: not counted.
  std::uint64_t (*count_allocations)() noexcept = nullptr;
};

/// What the real-time side counts for itself: true even where a full queue dropped the record.
struct SessionCounters {
  std::uint64_t ticks_run = 0;        ///< tick() calls
  std::uint64_t skipped_periods = 0;  ///< missed deadlines; with ticks_run, all periods
  std::uint64_t allocations = 0;      ///< inside tick(), when counted
  Fault latched = Fault::kNone;       ///< the faults that stopped the run
  std::array<std::uint64_t, kFaultBits> faults{};  ///< ticks in which each bit was set
  std::uint64_t stopping_faults = 0;               ///< ticks with a fault that stops rendering
};

/// Runs a renderer, tick after tick, until its time is over, it is asked to stop, or a fault has
/// brought the device to neutral. Every tick ends as one record in a queue; a full queue drops the
/// record and counts it, and the tick never waits.
class Session {
 public:
  /// @pre renderer is armed and outlives this
  Session(HapticRenderer& renderer, const SessionConfig& config);
  /// Where it still runs: ramps to neutral first, which takes up to 100 ms.
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Real time: a thread of its own ticks at the renderer's period until the end.
  [[nodiscard]] Expected<SetupReport> start(const PeriodicThreadConfig& thread);
  /// True until the last record is in the queue.
  [[nodiscard]] bool running() const;
  void join();
  /// The next record, in order. One consumer.
  [[nodiscard]] bool tryPop(TickRecord& record) noexcept { return queue_.try_pop(record); }

  /// Simulated clock: ticks in the calling thread as fast as it goes, handing each record over.
  void runSimulated(const std::function<void(const TickRecord&)>& sink);

  /// Asks something of one of the next ticks, in order; false where the queue is full. From one
  /// thread at a time. Commands of a simulated run may also come from its sink.
  [[nodiscard]] bool tryCommand(const Command& command) noexcept {
    return commands_.try_push(command);
  }

  /// Begins the ramp to neutral; the session ends when it is done. Any thread, also from a signal
  /// handler.
  void requestStop() noexcept { renderer_.requestStop(); }
  /// Lets the exercise's effort fade out first; the loop itself begins the ramp when fade_out_s are
  /// over. Any thread, also a signal handler.
  void requestGentleStop() noexcept { gentle_stop_.store(true); }
  /// Whether whoever shows the exercise is there: while not, its effort fades out. The newest word
  /// counts, and none is lost however full the queue of commands is. Any thread.
  void setOwnerAlive(bool alive) noexcept { owner_alive_.store(alive); }
  /// The same as requestStop(), and the records say that it was an emergency stop. Any thread,
  /// signal handlers too.
  void requestEmergencyStop() noexcept { renderer_.requestEmergencyStop(); }

  [[nodiscard]] std::uint64_t droppedRecords() const { return queue_.dropped(); }
  /// Valid once the session has ended.
  [[nodiscard]] SessionCounters counters() const { return counters_; }

 private:
  [[nodiscard]] std::uint64_t allocationsSoFar() const noexcept;
  [[nodiscard]] bool tickOnce(std::uint32_t elapsed_periods, std::int64_t lateness_ns) noexcept;
  void followStops() noexcept;
  void takeCommands() noexcept;
  void count(std::uint64_t allocations) noexcept;

  HapticRenderer& renderer_;
  const SessionConfig config_;
  const std::uint64_t fade_ticks_;
  SpscQueue<TickRecord> queue_;
  SpscQueue<Command> commands_;
  TickTimer timer_;
  TickRecord record_;  ///< reused: the tick's own copy
  std::uint64_t next_tick_ = 0;
  bool time_is_over_ = false;
  std::atomic<bool> gentle_stop_{false}, owner_alive_{true};
  bool fading_ = false, ramp_asked_ = false, owner_told_alive_ = true;  ///< of the ticking thread
  std::uint64_t ramp_at_tick_ = 0;                                      ///< while fading_
  SessionCounters counters_;
  std::unique_ptr<PeriodicThread> thread_;  ///< last: joined before what it writes to goes
};

}  // namespace wholehand
