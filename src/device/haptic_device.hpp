#pragma once

#include "core/axis_array.hpp"
#include "core/expected.hpp"
#include "core/fault.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// What a device says in one tick.
struct DeviceReading {
  AxisPosition q_m;           ///< measured position [m or rad]
  AxisPosition intention;     ///< the virtual patient's aim; size 0 on a real device
  AxisEffort patient_effort;  ///< what the virtual patient applies; size 0 on a real device
};

/// A grounded haptic device: N positions in, N efforts out. The simulated one, the replayed one and
/// a real one take the same path.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  /// Prepares the device; it holds its neutral effort. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> open() = 0;

  /// Whether it may be armed now, after open(): it is calibrated and at rest; the reason otherwise.
  /// Not real-time safe.
  [[nodiscard]] virtual Expected<Done> ready() = 0;

  /// True where no person is moved and no wall clock matters: lateness and encoders that stand
  /// still are then counted only.
  [[nodiscard]] virtual bool simulated() const noexcept { return false; }

  /// Reads the position. elapsed_periods is 1 plus the periods skipped since the last read; a real
  /// device ignores it, a simulated one lets that much time pass under the last effort.
  [[nodiscard]] WHOLEHAND_RT virtual Fault read(DeviceReading& reading,
                                                int elapsed_periods) noexcept = 0;

  /// Sends an effort; it holds until the next one. Software that has crashed, was killed or stands
  /// still sends none: the drive needs a watchdog of its own (20 ms, say) that lets it down gently.
  [[nodiscard]] WHOLEHAND_RT virtual Fault write(const AxisEffort& effort) noexcept = 0;

  /// Leaves the device at its neutral effort, its weight carried. Idempotent. Not real-time safe.
  virtual void close() noexcept = 0;
};

}  // namespace wholehand
