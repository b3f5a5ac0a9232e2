#include "telemetry/fault_text.hpp"

#include <gtest/gtest.h>

namespace wholehand::test {
namespace {

std::vector<DeviceAxis> axesNamed(const std::vector<std::string>& names) {
  std::vector<DeviceAxis> axes;
  for (const std::string& name : names) {
    axes.emplace_back();
    axes.back().name = name;
  }
  return axes;
}

TEST(FaultText, FaultOfAnAxis_NamesIt) {
  const std::vector<DeviceAxis> axes = axesNamed({"x", "y", "finger_flexion"});
  TickSummary summary;
  summary.faults[6] = 12;  // the bits of core/fault.hpp
  summary.faults[7] = 3;
  summary.fault_axes[6][0] = 9;
  summary.fault_axes[6][2] = 2;  // in one tick another fault was first
  summary.faults[12] = 1;
  summary.fault_axes[12][1] = 1;
  EXPECT_EQ(noticeText(summary, axes),
            "effort limited in 12 ticks (x 9, finger_flexion 2), late tick in 3 ticks");
  EXPECT_EQ(faultText(summary, axes), "speed limit exceeded in 1 tick (y)");
  EXPECT_EQ(faultText(summary), "speed limit exceeded in 1 tick") << "the axes have no names";
}

TEST(FaultText, EveryLimitThatHeldAnEffort_IsToldAsNoticed) {
  TickSummary summary;
  summary.faults[14] = 1;  // the bits of core/fault.hpp
  summary.faults[15] = 2;
  summary.fault_axes[15][0] = 2;
  summary.faults[22] = 3;
  EXPECT_EQ(noticeText(summary, axesNamed({"x"})), std::string(faultName(14)) + " in 1 tick, " +
                                                       faultName(15) + " in 2 ticks (x), " +
                                                       faultName(22) + " in 3 ticks");
  EXPECT_EQ(faultText(summary), "none");
}

}  // namespace
}  // namespace wholehand::test
