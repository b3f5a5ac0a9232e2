#pragma once

#include "loop/device/haptic_device.hpp"

namespace wholehand::test {

/// Opens and enables a device, as arming does.
inline Expected<Done> openEnabled(HapticDevice& device) {
  if (Expected<Done> opened = device.open(); !opened) return opened;
  return device.enable();
}

}  // namespace wholehand::test
