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

  /// Reads the position. elapsed_periods is 1 plus the periods skipped since the last read; a real
  /// device ignores it, a simulated one lets that much time pass under the last effort.
  [[nodiscard]] WHOLEHAND_RT virtual Fault read(DeviceReading& reading,
                                                int elapsed_periods) noexcept = 0;

  /// Sends an effort; it holds until the next one.
  [[nodiscard]] WHOLEHAND_RT virtual Fault write(const AxisEffort& effort) noexcept = 0;

  /// Leaves the device at its neutral effort. Idempotent. Not real-time safe.
  virtual void close() noexcept = 0;
};

}  // namespace wholehand
