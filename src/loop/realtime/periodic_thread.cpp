#include "loop/realtime/periodic_thread.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <string>
#include <utility>

namespace wholehand {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

void sleepUntil(std::int64_t instant_ns) noexcept {
  const timespec instant{instant_ns / kSecond_ns, instant_ns % kSecond_ns};
  while (clock_nanosleep(CLOCK_BOOTTIME, TIMER_ABSTIME, &instant, nullptr) == EINTR) {
  }
}

Diagnostics validate(const PeriodicThreadConfig& c) {
  Diagnostics faults;
  if (c.period_ns < 10'000 || c.period_ns > kSecond_ns) {
    faults.push_back(keyFault("", "period_ns", std::to_string(c.period_ns), "is out of range",
                              "must be in [10000, 1000000000] ns"));
  }
  if (c.stack_bytes < (std::size_t{64} << 10U) || c.stack_bytes > (std::size_t{64} << 20U)) {
    faults.push_back(keyFault("", "stack_bytes", std::to_string(c.stack_bytes), "is out of range",
                              "must be in [65536, 67108864] bytes"));
  }
  return faults;
}

Diagnostic noThread(int error) {
  return fileFault("", std::string("the system gives no thread: ") + std::strerror(error),
                   "check ulimit -u and the free memory");
}

}  // namespace

PeriodicThread::PeriodicThread(const PeriodicThreadConfig& config, Tick tick)
    : config_(config), tick_(std::move(tick)) {
  // Prefaulting more than half of the stack would leave no room for the loop's own frames.
  if (config_.setup.stack_bytes > config_.stack_bytes / 2) {
    config_.setup.stack_bytes = config_.stack_bytes / 2;
  }
}

PeriodicThread::~PeriodicThread() {
  stop_.store(true, std::memory_order_release);
  join();
}

Expected<SetupReport> PeriodicThread::start() {
  if (Diagnostics faults = validate(config_); !faults.empty()) {
    return faults;
  }
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, config_.stack_bytes);
  running_.store(true, std::memory_order_release);
  const int error = pthread_create(&thread_, &attributes, &PeriodicThread::threadMain, this);
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    running_.store(false, std::memory_order_release);
    return noThread(error);
  }
  joinable_ = true;
  ready_.wait(false, std::memory_order_acquire);
  return report_;
}

void PeriodicThread::join() noexcept {
  if (joinable_) {
    pthread_join(thread_, nullptr);
    joinable_ = false;
  }
}

void* PeriodicThread::threadMain(void* self) noexcept {
  auto& thread = *static_cast<PeriodicThread*>(self);
  pthread_setname_np(pthread_self(), "wholehand-loop");
  thread.report_ = setUpThread(thread.config_.setup);
  thread.ready_.store(true, std::memory_order_release);
  thread.ready_.notify_one();
  thread.loop();
  thread.running_.store(false, std::memory_order_release);
  return nullptr;
}

void PeriodicThread::loop() noexcept {
  const std::int64_t period_ns = config_.period_ns;
  std::int64_t last_ns = bootNow_ns();
  while (!stop_.load(std::memory_order_acquire)) {
    const std::int64_t due_ns = last_ns + period_ns;
    sleepUntil(due_ns);
    const std::int64_t now_ns = bootNow_ns();
    const Slot slot = slotAt(now_ns, last_ns, period_ns);
    last_ns = slot.start_ns;
    if (!tick_(slot.elapsed_periods, now_ns - due_ns)) {
      return;
    }
  }
}

}  // namespace wholehand
