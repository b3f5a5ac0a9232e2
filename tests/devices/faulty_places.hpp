#pragma once

#include "loop/device/haptic_device.hpp"

#include <gtest/gtest.h>

namespace wholehand::test {

/// Opens a device of x, y and z behind the faulty driver, which has z, roll, y, x at 1, 2, 3, 4
/// mm: its file's order counts.
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
