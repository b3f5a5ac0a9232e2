#pragma once

#include <string>

namespace wholehand {

/// Delay of a real device from a command to its effect, as measured at arming.
struct ArmingDelay {
  int periods = 0;  ///< whole periods that the certificate must allow for; 0: not measured
  /// "the delay is 5.45 ms now (drive 3.40 ms, transport 2.05 ms), the passport's 3.45 ms"; for a
  /// person.
  std::string sentence = {};
};

/// A device whose delay is measured at arming.
class DelayedDevice {
 public:
  virtual ~DelayedDevice() = default;
  [[nodiscard]] virtual const ArmingDelay& armingDelay() const noexcept = 0;
};

}  // namespace wholehand
