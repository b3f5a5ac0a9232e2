#pragma once

#include "device/haptic_device.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// Device data of a recorded tick.
struct RecordedReading {
  DeviceReading reading;
  PersonReading person;
  std::uint32_t elapsed_periods = 1;
  Fault faults = Fault::kNone;  ///< of the tick; the device's own bits are replayed
};

/// A device that replays a recording tick by tick, whatever is written to it. Recorded read and
/// write faults recur in their tick. Past the end every read fails (kDeviceRead).
class ReplayDevice final : public HapticDevice, public KnownPerson {
 public:
  /// @param simulated whether the recorded device was simulated: the same watchdogs then apply
  explicit ReplayDevice(std::vector<RecordedReading> ticks, bool simulated = true);

  /// Rewinds to the first tick. Never fails.
  [[nodiscard]] Expected<Done> open() override;
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }
  /// Returns the next recorded reading; ignores elapsed_periods, like a real device.
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  void close() noexcept override;
  /// The recorded person; the recording moves the device.
  void report(PersonReading& reading) const noexcept override;

  /// Periods of the next recorded tick, to be passed to the tick, so that the laws see the recorded
  /// k. 1 past the end. Real-time safe.
  [[nodiscard]] int nextElapsedPeriods() const noexcept;
  /// True when every recorded tick has been read. Real-time safe.
  [[nodiscard]] bool atEnd() const noexcept { return next_ == ticks_.size(); }

 private:
  std::vector<RecordedReading> ticks_;
  std::size_t next_ = 0;
  bool simulated_;
  bool open_ = false;
};

}  // namespace wholehand
