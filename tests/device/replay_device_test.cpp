#include "device/replay/replay_device.hpp"

#include "device/faulty/fault_injector.hpp"
#include "device/one_axis.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand {
namespace {

RecordedReading recorded(double position, std::uint32_t elapsed, Fault faults = Fault::kNone) {
  RecordedReading r;
  r.reading = {AxisPosition(2, position)};
  r.person = {AxisPosition(2, position + 1.0), AxisEffort(2, position + 2.0)};
  r.elapsed_periods = elapsed;
  r.faults = faults;
  return r;
}

TEST(ReplayDevice, Recording_IsReadInOrderWithItsSkippedPeriods) {
  ReplayDevice device({recorded(0.1, 1), recorded(0.2, 3), recorded(0.3, 1)});
  ASSERT_TRUE(device.open().ok());
  DeviceReading reading;
  PersonReading person;
  for (const auto& [position, elapsed] : {std::pair{0.1, 1}, {0.2, 3}, {0.3, 1}}) {
    EXPECT_EQ(device.nextElapsedPeriods(), elapsed);
    ASSERT_EQ(device.read(reading, elapsed), Fault::kNone);
    EXPECT_EQ(reading.q_m[1], position);
    device.report(person);
    EXPECT_EQ(person.intention[1], position + 1.0);
    EXPECT_EQ(person.effort[1], position + 2.0);
    EXPECT_EQ(device.write(AxisEffort(2, 9.0)), Fault::kNone);
  }
  EXPECT_TRUE(device.atEnd());
  EXPECT_EQ(device.read(reading, 1), Fault::kDeviceRead);
}

TEST(ReplayDevice, RecordedFaults_ComeBackInTheirTick) {
  ReplayDevice device({recorded(0.1, 1), recorded(0.2, 1, Fault::kDeviceRead | Fault::kLateTick),
                       recorded(0.3, 1, Fault::kDeviceWrite | Fault::kEffortLimit)});
  ASSERT_TRUE(device.open().ok());
  DeviceReading reading;
  EXPECT_EQ(device.read(reading, 1), Fault::kNone);
  EXPECT_EQ(device.write(AxisEffort(2)), Fault::kNone);
  EXPECT_EQ(device.read(reading, 1), Fault::kDeviceRead);  // and only the device's own bit
  EXPECT_EQ(device.write(AxisEffort(2)), Fault::kNone);
  EXPECT_EQ(device.read(reading, 1), Fault::kNone);
  EXPECT_EQ(device.write(AxisEffort(2)), Fault::kDeviceWrite);
}

TEST(ReplayDevice, OpenedAgain_StartsAgain) {
  ReplayDevice device({recorded(0.1, 1), recorded(0.2, 1)});
  DeviceReading reading;
  EXPECT_EQ(device.read(reading, 1), Fault::kDeviceRead);  // not open yet
  for (int run = 0; run < 2; ++run) {
    ASSERT_TRUE(device.open().ok());
    ASSERT_EQ(device.read(reading, 1), Fault::kNone);
    EXPECT_EQ(reading.q_m[0], 0.1);
    device.close();
  }
}

TEST(FaultInjector, InjectedFaults_AppearInTheirTicksOnly) {
  using Kind = InjectedKind;
  SimulatedDevice inner(test::oneAxisDevice(1.0), test::nobody(), test::stayAt(0.0), 1e-3);
  FaultInjector device(
      inner, {{Kind::kNanPosition, 1, 1}, {Kind::kReadFails, 2, 3}, {Kind::kWriteFails, 4, 4}});
  ASSERT_TRUE(device.open().ok());
  DeviceReading reading;
  for (int tick = 0; tick < 6; ++tick) {
    const bool fails = tick == 2 || tick == 3;
    EXPECT_EQ(device.read(reading, 1), fails ? Fault::kDeviceRead : Fault::kNone) << tick;
    EXPECT_EQ(std::isnan(reading.q_m[0]), tick >= 1 && tick <= 3) << tick;
    EXPECT_EQ(device.write(AxisEffort(1, 1.0)), tick == 4 ? Fault::kDeviceWrite : Fault::kNone);
  }
  // 1 N on 1 kg in each of five periods: the failed write left the same effort standing.
  EXPECT_NEAR(inner.velocity()[0], 5e-3, 1e-15);
}

}  // namespace
}  // namespace wholehand
