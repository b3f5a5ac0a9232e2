#include "devices/plugin/device_driver.hpp"

#include <cmath>
#include <limits>

namespace wholehand {

DeviceFacts ObservedDriver::facts() const noexcept {
  const std::uint32_t status = status_.load(std::memory_order_relaxed);
  DeviceFacts out;
  out.enabled = (status & WH_ENABLED) != 0;
  out.homed = (status & WH_HOMED) != 0;
  out.silenced = (status & WH_SILENCED) != 0;
  out.temperature_c = temperature_c_.load(std::memory_order_relaxed);
  out.sampled_ns = sampled_ns_.load(std::memory_order_relaxed);
  return out;
}

Expected<Done> ObservedDriver::control(std::uint32_t verb, double argument) {
  Expected<Done> done = driver_->control(verb, argument);
  // The flag is cleared here because no samples follow.
  if (verb == WH_DISABLE && done) {
    status_.fetch_and(~static_cast<std::uint32_t>(WH_ENABLED), std::memory_order_relaxed);
  }
  return done;
}

int ObservedDriver::read(wh_sample& sample) noexcept {
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

}  // namespace wholehand
