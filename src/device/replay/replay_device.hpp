#pragma once

#include "device/haptic_device.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// What a recorded tick knows of the device.
struct RecordedReading {
  DeviceReading reading;
  std::uint32_t elapsed_periods = 1;
  Fault faults = Fault::kNone;  ///< of the tick; the device's own bits are given again
};

/// A device that repeats a recording, tick by tick, whatever is written to it. A recorded read or
/// write fault is returned again in its tick; past the end every read fails (kDeviceRead).
class ReplayDevice final : public HapticDevice {
 public:
  /// @param simulated whether the recorded device was: a re-simulation watches what it watched
  explicit ReplayDevice(std::vector<RecordedReading> ticks, bool simulated = true);

  /// Starts again at the first tick. Never fails.
  [[nodiscard]] Expected<Done> open() override;
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }
  /// The next recorded reading; elapsed_periods is ignored, as by a real device.
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  void close() noexcept override;

  /// How many periods the next recorded tick took: whoever drives a re-simulation passes it on, so
  /// that laws see the recorded k and no clock. 1 past the end. Real-time safe.
  [[nodiscard]] int nextElapsedPeriods() const noexcept;
  /// True when every recorded tick was read. Real-time safe.
  [[nodiscard]] bool atEnd() const noexcept { return next_ == ticks_.size(); }

 private:
  std::vector<RecordedReading> ticks_;
  std::size_t next_ = 0;
  bool simulated_;
  bool open_ = false;
};

}  // namespace wholehand
