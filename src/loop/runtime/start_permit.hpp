#pragma once

#include "loop/core/real_time.hpp"

namespace wholehand {

/// Permit for the effort of a session to begin. The loop judges it once, in the first tick:
/// enabling a device may take long, and the person who pressed Start may have left meanwhile.
class StartPermit {
 public:
  virtual ~StartPermit() = default;
  /// Judges the permit. If false, the session sends the neutral effort only and ends, as after a
  /// stop.
  [[nodiscard]] WHOLEHAND_RT virtual bool judge() noexcept = 0;
};

}  // namespace wholehand
