#include "device/replay/replay_device.hpp"

#include <utility>

namespace wholehand {
ReplayDevice::ReplayDevice(std::vector<RecordedReading> ticks, bool simulated)
    : ticks_(std::move(ticks)), simulated_(simulated) {}

Expected<Done> ReplayDevice::open() {
  open_ = true;
  next_ = 0;
  return Done{};
}

Fault ReplayDevice::read(DeviceReading& reading, int /*elapsed_periods*/) noexcept {
  if (!open_ || atEnd()) return Fault::kDeviceRead;
  const RecordedReading& tick = ticks_[next_++];
  reading = tick.reading;
  return tick.faults & kOfReading;
}

void ReplayDevice::report(PersonReading& reading) const noexcept {
  if (next_ == 0) return;
  reading = ticks_[next_ - 1].person;
  reading.moved_by = Mover::kMotion;
}

Fault ReplayDevice::write(const AxisEffort& /*effort*/) noexcept {
  if (!open_) return Fault::kDeviceWrite;
  // A write belongs to the tick that was read last.
  return next_ == 0 ? Fault::kNone : ticks_[next_ - 1].faults & Fault::kDeviceWrite;
}

void ReplayDevice::close() noexcept {
  open_ = false;
}

int ReplayDevice::nextElapsedPeriods() const noexcept {
  return atEnd() ? 1 : static_cast<int>(ticks_[next_].elapsed_periods);
}

}  // namespace wholehand
