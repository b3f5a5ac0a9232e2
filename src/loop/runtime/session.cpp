#include "loop/runtime/session.hpp"

#include "loop/realtime/monotonic_clock.hpp"
#include "loop/realtime/thread_setup.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

namespace wholehand {

Session::Session(HapticRenderer& renderer, const SessionConfig& config)
    : renderer_(renderer),
      config_(config),
      queue_(config.queue_bytes),
      commands_(config.queue_commands) {
  for (std::atomic<double>& value : wanted_) value = std::numeric_limits<double>::quiet_NaN();
  taken_.fill(std::numeric_limits<double>::quiet_NaN());
}

Session::~Session() {
  // Only a running loop gets the request; otherwise the next session's renderer would find it.
  if (running()) requestStop();
  join();
}

Expected<SetupReport> Session::start(const PeriodicThreadConfig& thread) {
  if (std::llround(renderer_.config().period_s * 1e9) != thread.period_ns) {
    renderer_.disarm();
    return keyFault("", "period_ns", std::to_string(thread.period_ns),
                    "is not the period that the gains were judged at",
                    "use the period that the rig was built with");
  }
  thread_ = std::make_unique<PeriodicThread>(
      thread, [this](std::uint32_t elapsed_periods, std::int64_t lateness_ns) noexcept {
        if (counters_.ticks_run == 0) noteTime();
        const bool more = tickOnce(elapsed_periods, lateness_ns);
        noteTick(more);
        (void)queue_.try_push(record_);  // a full queue drops the record and counts it
        if (!more && config_.interrupts != nullptr) --config_.interrupts->loops;
        return more;
      });
  has_thread_.store(true, std::memory_order_release);
  if (config_.interrupts != nullptr) {
    config_.interrupts->ticked_ns.store(monotonicNow_ns());
    ++config_.interrupts->loops;
  }
  Expected<SetupReport> started = thread_->start();
  if (!started) {
    if (config_.interrupts != nullptr) --config_.interrupts->loops;
    renderer_.disarm();
  }
  return started;
}

bool Session::running() const {
  return has_thread_.load(std::memory_order_acquire) && thread_->running();
}

void Session::join() {
  if (thread_ != nullptr) thread_->join();
}

void Session::runSimulated(const std::function<void(const TickRecord&)>& sink) {
  // As in the real-time thread, so that both clocks give the same bits.
  const DenormalsFlushed scope;
  bool more = true;
  while (more) {
    more = tickOnce(1, 0);
    sink(record_);
  }
}

std::uint64_t Session::allocationsSoFar() const noexcept {
  return config_.count_allocations != nullptr ? config_.count_allocations() : 0;
}

bool Session::tickOnce(std::uint32_t elapsed_periods, std::int64_t lateness_ns) noexcept {
  const std::uint64_t allocated = allocationsSoFar();
  timer_.start();
  // The first period starts rendering; periods skipped before it do not count.
  record_.tick = counters_.ticks_run == 0 ? 0 : next_tick_ + elapsed_periods - 1;
  record_.time_s = static_cast<double>(record_.tick) * renderer_.config().period_s;
  record_.lateness_ns = lateness_ns;
  followInterrupts();
  takeCommands();
  judgePermit();  // after the commands: it knows every limit that is in force in this tick
  if (config_.listener != nullptr) config_.listener->beforeTick(record_);
  if (config_.black_box != nullptr) config_.black_box->beforeTick(record_);
  renderer_.tick(counters_.ticks_run == 0 ? 1 : elapsed_periods, record_, &timer_);
  next_tick_ = record_.tick + 1;
  if (next_tick_ >= config_.duration_ticks && !std::exchange(time_is_over_, true)) {
    renderer_.requestStop();
  }
  timer_.finish(record_);
  if (config_.listener != nullptr) config_.listener->afterTick(record_);
  if (config_.black_box != nullptr) config_.black_box->afterTick(record_);
  count(allocationsSoFar() - allocated);
  return !renderer_.finished();
}

// The last moment before effort: what was judged before the device was enabled may have changed.
void Session::judgePermit() noexcept {
  if (counters_.ticks_run > 0 || config_.permit == nullptr) return;
  if (!config_.permit->judge()) renderer_.requestStop();
}

void Session::noteTime() noexcept {
  const std::int64_t now_ns = monotonicNow_ns();
  ticked_ns_.store(now_ns);
  if (config_.interrupts != nullptr) config_.interrupts->ticked_ns.store(now_ns);
}

// The time comes last, so that a reader of a new time reads what belongs to it, or is newer.
void Session::noteTick(bool more) noexcept {
  constexpr Fault kStops = Fault::kStopRequested | Fault::kEmergencyStop;
  const bool accepted = !any(record_.faults & Fault::kDeviceWrite);
  obeyed_stops_.store(accepted ? record_.faults & kStops : Fault::kNone);
  at_neutral_.store(renderer_.atNeutral());
  over_.store(!more);
  noteTime();
}

// Stops the loop after a signal. This needs no other thread.
void Session::followInterrupts() noexcept {
  const bool asked = config_.interrupts != nullptr && config_.interrupts->asked.load() > 0;
  if (asked && !std::exchange(interrupted_, true)) renderer_.requestGentleStop();
}

void Session::takeCommands() noexcept {
  record_.command_count = 0;
  const bool alive = holder_alive_.load();
  if (alive != reported_alive_) {
    Command& sign = record_.commands[0];
    sign = Command{};
    sign.type = CommandType::kHolderAlive;
    sign.value = alive ? 1.0 : 0.0;
    record_.command_count = 1;
    reported_alive_ = alive;
  }
  takeParameters();
  while (record_.command_count < kMaxCommands) {
    Command& command = record_.commands[record_.command_count];
    if (!commands_.try_pop(command)) break;
    ++record_.command_count;
  }
}

// Parameters beyond the record's room follow in the next ticks.
void Session::takeParameters() noexcept {
  for (int i = 0; i < kMaxLiveParameters && record_.command_count < kMaxCommands; ++i) {
    const double value = wanted_[i].load();
    if (std::isnan(value) || value == taken_[i]) continue;
    Command& command = record_.commands[record_.command_count++];
    command = Command{};
    command.type = CommandType::kParameter;
    command.index = i;
    command.value = taken_[i] = value;
  }
}

void Session::count(std::uint64_t allocations) noexcept {
  SessionCounters& c = counters_;
  ++c.ticks_run;
  c.skipped_periods += record_.elapsed_periods - 1;
  c.allocations += allocations;
  c.latched = renderer_.latched();
  for (unsigned bit = 0; bit < kFaultBits; ++bit) {
    c.faults[bit] += static_cast<std::uint32_t>(record_.faults) >> bit & 1U;
  }
  if (any(record_.faults & kStoppingFaults)) ++c.stopping_faults;
}

}  // namespace wholehand
