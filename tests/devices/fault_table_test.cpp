// Injects every kind of device fault behind every shipped adapter at random ticks: the ramp begins
// at most one tick after the sample that reports it. Samples are interpreted here by device.h
// alone, independently of PluginDevice. FailingDevice in plugin_device_test.cpp tests for a whole
// rig that a stopping fault begins the ramp in its own tick.
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
  int latest;     ///< largest number of healthy ticks before the fault
  int cases;      ///< runs for each kind; 1,000 with WHOLEHAND_FULL=1
  int most_said;  ///< largest number of ticks from the fault to the sample that reports it; frozen
                  ///< samples take longer
};

const Row kTable[] = {
    {"driver",
     &makeDirect,
     {"unplug", "missing", "drive", "enable", "unhomed", "silenced", "backwards", "clock", "frozen",
      "nothing_new", "refuse"},
     1000,
     20,
     1},
    {"composite",
     &makeComposite,
     {"unplug", "missing", "drive", "enable", "unhomed", "silenced", "backwards", "clock", "frozen",
      "nothing_new", "refuse"},
     1000,
     20,
     8},  // a frozen part is invalid after 5 ms of skew
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

struct FaultTrace {
  int said = -1, began = -1;  ///< ticks from the fault to its report and to the ramp; -1: never
  bool healthy = true;        ///< no fault before the injected one
};

FaultTrace runInto(FaultAdapter& adapter, const char* kind, int at) {
  FaultTrace trace;
  const auto watched = std::make_shared<WatchedDriver>(adapter.driver());
  static const FaultAdapter* clock = nullptr;
  clock = &adapter;
  const auto device = orThrow(PluginDevice::make(watched, adapter.model(), 1e-3, std::nullopt,
                                                 []() noexcept { return clock->now_ns(); }));
  EXPECT_TRUE(openEnabled(*device));
  DeviceReading reading;
  const AxisEffort neutral(adapter.model().axisCount());
  for (int tick = 0; tick < at + 1100 && trace.began < 0; ++tick) {
    if (tick == at) adapter.injectFault(kind);
    adapter.pass();
    Fault faults = device->read(reading, 1);
    faults |= device->write(neutral);
    const bool reports = watched->reportsStop() || any(faults & Fault::kDeviceWrite);
    if (tick < at && (reports || any(faults & kStoppingFaults))) {
      trace.healthy = false;
      return trace;
    }
    if (trace.said < 0 && reports) trace.said = tick - at;
    if (any(faults & kStoppingFaults)) trace.began = tick - at;
  }
  device->close();
  return trace;
}

class FaultTable : public testing::TestWithParam<Row> {};

TEST_P(FaultTable, EveryFaultAtRandomTicks_RampsWithinATickOfTheReportingSample) {
  const Row& row = GetParam();
  const int runs = fullCounts() ? 1000 : kReducedCounts ? 2 : row.cases;
  auto random = seededRandom(1213);
  int judged = 0;
  for (const char* kind : row.kinds) {
    for (int i = 0; i < runs; ++i) {
      // The fault comes in tick 2 or later: a watchdog starts with the first command, which arrives
      // a tick after it was sent.
      const int at = 2 + static_cast<int>(random() % static_cast<unsigned>(row.latest));
      SCOPED_TRACE(std::string(row.adapter) + ", " + kind + " at tick " + std::to_string(at));
      const auto adapter = row.make();
      const FaultTrace trace = runInto(*adapter, kind, at);
      // In real time the machine may have stalled this loop, which is another fault.
      if (!trace.healthy && adapter->inRealTime()) continue;
      ASSERT_TRUE(trace.healthy);
      ASSERT_GE(trace.began, 0) << "never begins";
      const bool still = std::string(kind) == "frozen" || std::string(kind) == "nothing_new";
      const int most_said = row.most_said + (still ? kStill_ticks : 0);
      ++judged;
      // Frozen samples age: their mean age may end the session before the frozen sequence does.
      if (still && trace.said < 0) {
        ASSERT_LE(trace.began, most_said);
        continue;
      }
      ASSERT_GE(trace.said, 0) << "begins, and no sample says so";
      ASSERT_LE(trace.began - trace.said, 1);
      ASSERT_LE(trace.said, most_said);
    }
  }
  EXPECT_GT(judged, kReducedCounts ? 0 : static_cast<int>(row.kinds.size()))
      << "the table must not be empty";
}
INSTANTIATE_TEST_SUITE_P(Adapters, FaultTable, testing::ValuesIn(kTable), [](const auto& tested) {
  std::string name = tested.param.adapter;
  std::erase_if(name, [](char c) { return c == ' ' || c == '-'; });
  return name;
});

}  // namespace
}  // namespace wholehand::test
