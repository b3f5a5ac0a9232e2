#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/fault.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"

namespace wholehand {

/// What is known about the person at a device in one tick. About a real person only this is known:
/// moved_by is kPerson.
struct PersonReading {
  AxisPosition intention;           ///< position that the person wants to reach; size 0: unknown
  AxisEffort effort;                ///< effort of the person on the device; size 0: unknown
  Mover moved_by = Mover::kPerson;  ///< who decides the intention
  Help help = Help::kUnspecified;
};

/// A person about whom more is known than the device measures: a simulated or a recorded one.
/// Reports to the record, in addition to the device.
class KnownPerson {
 public:
  virtual ~KnownPerson() = default;

  /// Reports the person at the time of the device's last read; leaves `reading` unchanged when that
  /// read gave no position.
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

  /// Prepares the device: afterwards it can be read, and gives no effort yet. Idempotent. Not
  /// real-time safe.
  [[nodiscard]] virtual Expected<Done> open() = 0;

  /// Checks whether the device may be enabled, after open(): it is calibrated and at rest. Returns
  /// the reason if not. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> ready() = 0;

  /// Checks whether this device was shown to be fit to move a person (commissioned and checked).
  /// Returns the reason if not. The default is for devices that are not commissioned. Not real-time
  /// safe.
  [[nodiscard]] virtual Expected<Done> cleared() const { return Done{}; }

  /// Enables the device: efforts reach the motors from now on, beginning with the neutral effort.
  /// This is the last step of arming. A failure leaves the device as it was. The default is for
  /// devices that need no enabling. Idempotent. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> enable() { return Done{}; }

  /// True when the device moves no person and timing does not matter. Late ticks and stuck encoders
  /// are then only counted.
  [[nodiscard]] virtual bool simulated() const noexcept { return false; }

  /// Reads the position. A real device ignores elapsed_periods; a simulated one advances by that
  /// many periods under the last effort.
  /// @param elapsed_periods 1 + periods skipped since the last read
  [[nodiscard]] WHOLEHAND_RT virtual Fault read(DeviceReading& reading,
                                                int elapsed_periods) noexcept = 0;

  /// Sends an effort, which holds until the next one. A crashed, killed or stalled program sends
  /// nothing, so the drive needs its own watchdog (for example 20 ms) that releases the effort
  /// gently.
  [[nodiscard]] WHOLEHAND_RT virtual Fault write(const AxisEffort& effort) noexcept = 0;

  /// Closes the device and leaves it at its neutral effort, which carries its weight. Idempotent.
  /// Not real-time safe.
  virtual void close() noexcept = 0;
};

}  // namespace wholehand
