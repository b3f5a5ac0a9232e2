#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/fault.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"

namespace wholehand {

/// What is known of the person at a device in one tick. Of a real one: that it is one.
struct PersonReading {
  AxisPosition intention;           ///< where the person wants to be; size 0: unknown
  AxisEffort effort;                ///< of the person on the device; size 0: unknown
  Mover moved_by = Mover::kPerson;  ///< who decides the intention
  Help help = Help::kUnsaid;
};

/// A person of whom more is known than the device measures: a simulated or a recorded one. It
/// reports to the record, beside the device.
class KnownPerson {
 public:
  virtual ~KnownPerson() = default;

  /// Reports the person as of the device's last read; unchanged where the device gave none.
  WHOLEHAND_RT virtual void report(PersonReading& reading) const noexcept = 0;
};

/// Reading of a device in one tick.
struct DeviceReading {
  AxisPosition q_m;  ///< measured position [m or rad]
};

/// A grounded haptic device: N positions in, N efforts out. Simulated, replayed and real devices
/// share this interface and its path through the tick.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;

  /// Prepares the device: it can be read, and gives no effort yet. Idempotent. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> open() = 0;

  /// Whether the device may be enabled, after open(): calibrated and at rest. Returns the reason
  /// otherwise. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> ready() = 0;

  /// Whether it was shown that this device may move a person; the reason otherwise. The default is
  /// for devices that are not commissioned. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> cleared() const { return Done{}; }

  /// Lets efforts through, the neutral one first: the last step of arming. A failure leaves the
  /// device as it was. The default is for devices that need no enabling. Idempotent. Not real-time
  /// safe.
  [[nodiscard]] virtual Expected<Done> enable() { return Done{}; }

  /// True where no person is moved and timing does not matter. Late ticks and stuck encoders are
  /// then only counted.
  [[nodiscard]] virtual bool simulated() const noexcept { return false; }

  /// Reads the position. A real device ignores elapsed_periods; a simulated one advances by that
  /// many periods under the last effort.
  /// @param elapsed_periods 1 + periods skipped since the last read
  [[nodiscard]] WHOLEHAND_RT virtual Fault read(DeviceReading& reading,
                                                int elapsed_periods) noexcept = 0;

  /// Sends an effort, which holds until the next one. A crashed, killed or stalled program sends
  /// nothing, so the drive needs its own watchdog (20 ms, say) that lets go gently.
  [[nodiscard]] WHOLEHAND_RT virtual Fault write(const AxisEffort& effort) noexcept = 0;

  /// Leaves the device at its neutral effort, which carries its weight. Idempotent. Not real-time
  /// safe.
  virtual void close() noexcept = 0;
};

}  // namespace wholehand
