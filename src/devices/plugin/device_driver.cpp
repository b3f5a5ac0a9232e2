#include "devices/plugin/device_driver.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <cmath>
#include <limits>

namespace wholehand {
namespace {

/// Notes when a call has to return, for as long as it lasts.
class Call {
 public:
  Call(std::atomic<std::int64_t>& due_ns, double within_s) noexcept : due_ns_(due_ns) {
    due_ns_.store(monotonicNow_ns() + static_cast<std::int64_t>(1e9 * within_s));
  }
  ~Call() { due_ns_.store(0); }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

 private:
  std::atomic<std::int64_t>& due_ns_;
};

}  // namespace

DeviceFacts ObservedDriver::facts() const noexcept {
  const std::uint32_t status = status_.load(std::memory_order_relaxed);
  DeviceFacts out;
  out.enabled = (status & WH_ENABLED) != 0;
  out.homed = (status & WH_HOMED) != 0;
  out.silenced = (status & WH_SILENCED) != 0;
  out.temperature_c = temperature_c_.load(std::memory_order_relaxed);
  out.sampled_ns = sampled_ns_.load(std::memory_order_relaxed);
  const std::int64_t due_ns = due_ns_.load();
  out.overdue = due_ns != 0 && monotonicNow_ns() > due_ns;
  return out;
}

Expected<Done> ObservedDriver::reconnect() {
  Expected<Done> found = driver_->reconnect();
  identity_ = driver_->identity();  // of another device, where a host was started again
  return found;
}

Expected<Done> ObservedDriver::enable(const wh_command& neutral) {
  const Call call(due_ns_, driver_->switchesWithin_s());
  return driver_->enable(neutral);
}

Expected<Done> ObservedDriver::control(std::uint32_t verb, double argument) {
  if (verb != WH_ENABLE && verb != WH_DISABLE) return driver_->control(verb, argument);
  const Call call(due_ns_, driver_->switchesWithin_s());
  Expected<Done> done = driver_->control(verb, argument);
  // The flag is cleared here because no samples follow.
  if (verb == WH_DISABLE && done) {
    status_.fetch_and(~static_cast<std::uint32_t>(WH_ENABLED), std::memory_order_relaxed);
  }
  return done;
}

int ObservedDriver::read(wh_sample& sample) noexcept {
  const Call call(due_ns_, kCallWithin_s);
  const int result = driver_->read(sample);
  if (result < 0) return result;
  double highest_c = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < driver_->axes().size(); ++i) {
    highest_c = std::fmax(highest_c, sample.temperature_c[i]);  // fmax ignores NaN
  }
  status_.store(sample.status, std::memory_order_relaxed);
  temperature_c_.store(highest_c, std::memory_order_relaxed);
  sampled_ns_.store(sample.monotonic_ns, std::memory_order_relaxed);
  return result;
}

int ObservedDriver::write(const wh_command& command) noexcept {
  const Call call(due_ns_, kCallWithin_s);
  return driver_->write(command);
}

}  // namespace wholehand
