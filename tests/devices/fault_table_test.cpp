// Every kind of fault of a device, behind every adapter that ships, at random ticks: the ramp
// begins at most a tick after the sample that says so. What a sample says is read here by device.h
// alone, beside PluginDevice; that a stopping fault begins the ramp in its own tick, for a whole
// rig: FailingDevice.InATick_IsReportedAndRampsToNeutral in plugin_device_test.cpp.
#include "devices/fault_table_adapters.hpp"
#include "support/figure.hpp"
#include "support/open_enabled.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

struct Row {
  const char* adapter;
  std::unique_ptr<FaultAdapter> (*make)();
  std::vector<const char*> kinds;
  int latest;     ///< ticks of healthy samples before the fault, at the most
  int cases;      ///< of each kind; 1,000 with WHOLEHAND_FULL=1
  int most_said;  ///< ticks from the fault to the sample that says it; standing still is more
};

const Row kTable[] = {
    {"driver",
     &makeDirect,
     {"unplug", "missing", "drive", "enable", "unhomed", "silenced", "backwards", "clock", "frozen",
      "refuse"},
     1000,
     20,
     1},
    {"composite",
     &makeComposite,
     {"unplug", "missing", "drive", "enable", "unhomed", "silenced", "backwards", "clock", "frozen",
      "refuse"},
     1000,
     20,
     8},  // 5 ms of skew before a part that stands still is not valid
    {"frame",
     &makeFrame,
     {"unplug", "missing", "drive", "unhomed", "silenced", "frozen"},
     1000,
     20,
     2},
    {"moteus", &makeMoteus, {"unplug", "drive", "unhomed", "silenced", "frozen"}, 1000, 20, 3},
    {"Force Dimension",
     &makeForceDimension,
     {"unplug", "drive", "enable", "unhomed", "silenced", "refuse"},
     1000,
     20,
     1},
    {"host",
     &makeHosted,
     {"unplug", "missing", "drive", "enable", "unhomed", "silenced"},
     30,
     3,
     1000},
};

constexpr int kStill_ticks = 22;  // desktop-3axis allows 20 ms

struct Course {
  int said = -1, began = -1;  ///< ticks after the fault
  bool healthy = true;        ///< until then
};

Course runInto(FaultAdapter& adapter, const char* kind, int at) {
  Course course;
  const auto watched = std::make_shared<WatchedDriver>(adapter.driver());
  static const FaultAdapter* clock = nullptr;
  clock = &adapter;
  const auto device = orThrow(PluginDevice::make(watched, adapter.model(), 1e-3, std::nullopt,
                                                 []() noexcept { return clock->now_ns(); }));
  EXPECT_TRUE(openEnabled(*device));
  DeviceReading reading;
  const AxisEffort neutral(adapter.model().axisCount());
  for (int tick = 0; tick < at + 1100 && course.began < 0; ++tick) {
    if (tick == at) adapter.injectFault(kind);
    adapter.pass();
    Fault faults = device->read(reading, 1);
    faults |= device->write(neutral);
    const bool says = watched->saysStop() || any(faults & Fault::kDeviceWrite);
    if (tick < at && (says || any(faults & kStoppingFaults))) {
      course.healthy = false;
      return course;
    }
    if (course.said < 0 && says) course.said = tick - at;
    if (any(faults & kStoppingFaults)) course.began = tick - at;
  }
  device->close();
  return course;
}

class FaultTable : public testing::TestWithParam<Row> {};

TEST_P(FaultTable, OfEveryKindAtRandomTicks_BeginsTheRampAtMostATickAfterTheSampleSaysSo) {
  const Row& row = GetParam();
  const int runs = fullCounts() ? 1000 : kFew ? 2 : row.cases;
  auto random = seededRandom(1213);
  int judged = 0;
  for (const char* kind : row.kinds) {
    for (int i = 0; i < runs; ++i) {
      // From 2 on: a watchdog begins with the first command, which arrives a tick after it was
      // sent.
      const int at = 2 + static_cast<int>(random() % static_cast<unsigned>(row.latest));
      SCOPED_TRACE(std::string(row.adapter) + ", " + kind + " at tick " + std::to_string(at));
      const auto adapter = row.make();
      const Course course = runInto(*adapter, kind, at);
      // In real time the machine may have let this loop stand still: that is another fault.
      if (!course.healthy && adapter->inRealTime()) continue;
      ASSERT_TRUE(course.healthy);
      ASSERT_GE(course.began, 0) << "never begins";
      const bool still = std::string(kind) == "frozen";
      const int most_said = row.most_said + (still ? kStill_ticks : 0);
      ++judged;
      // Samples that stand still age: their mean age may end the session before the standstill.
      if (still && course.said < 0) {
        ASSERT_LE(course.began, most_said);
        continue;
      }
      ASSERT_GE(course.said, 0) << "begins, and no sample says so";
      ASSERT_LE(course.began - course.said, 1);
      ASSERT_LE(course.said, most_said);
    }
  }
  EXPECT_GT(judged, kFew ? 0 : static_cast<int>(row.kinds.size())) << "the table must not be empty";
}
INSTANTIATE_TEST_SUITE_P(Adapters, FaultTable, testing::ValuesIn(kTable), [](const auto& tested) {
  std::string name = tested.param.adapter;
  std::erase_if(name, [](char c) { return c == ' ' || c == '-'; });
  return name;
});

}  // namespace
}  // namespace wholehand::test
