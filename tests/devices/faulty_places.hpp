#pragma once

#include "loop/device/haptic_device.hpp"

#include <gtest/gtest.h>

namespace wholehand::test {

/// Opens a device of x, y and z behind the faulty driver, whose z, roll, y, x are at 1, 2, 3, 4 mm.
/// The order of the device file must apply.
inline void expectPlacesOfFaultyDriver(HapticDevice& device) {
  ASSERT_TRUE(device.open());
  ASSERT_TRUE(device.ready());
  DeviceReading reading;
  ASSERT_EQ(device.read(reading, 1), Fault::kNone);
  EXPECT_EQ(reading.q_m[0], 0.004);
  EXPECT_EQ(reading.q_m[1], 0.003);
  EXPECT_EQ(reading.q_m[2], 0.001);
}

}  // namespace wholehand::test
