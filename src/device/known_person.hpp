#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"
#include "core/tick_record.hpp"

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

}  // namespace wholehand
