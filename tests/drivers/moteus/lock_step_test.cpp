// The same virtual patient on the built-in device and behind the drivers of Force Dimension and
// moteus, period by period on a simulated clock. Differences come only from the rounding of the
// drivers and their wires.
#include "devices/plugin/plugin_device.hpp"
#include "force_dimension/fake_sdk.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "moteus_in_step.hpp"
#include "rig/models.hpp"
#include "support/figure.hpp"
#include "support/rig_tools.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace wholehand::test {
namespace {

constexpr double kLoopPeriod_s = 1e-3;
constexpr int kLockSteps = 5000;
constexpr double kTorqueStep_nm =
    0.01;  // step of a torque as int16 (moteus documentation); also used in N
constexpr double kRev_rad = 2.0 * std::numbers::pi;

Models patientOn(const std::vector<std::string>& axes) {
  Models models = load(shippedFiles());
  keepAxes(models, axes);
  return models;
}

// Moves every axis between a tenth and nine tenths of its range, each at its own pace.
Intention travels(const DeviceModel& device) {
  std::vector<Waypoint> way;
  for (int i = 0; i <= 10; ++i) {
    AxisPosition q(device.axisCount());
    for (int a = 0; a < q.size(); ++a) {
      const DeviceAxis& axis = device.axes[a];
      const double share = i == 0 ? 0.5 : (i * (a + 3)) % 5 / 5.0;
      q[a] = axis.lower + (axis.upper - axis.lower) * (0.1 + 0.8 * share);
    }
    way.push_back({0.5 * i, q});
  }
  return Intention::throughWaypoints(std::move(way));
}

std::unique_ptr<SimulatedDevice> plantOf(const Models& models, int delay_ticks) {
  DeviceModel device = models.device;
  device.output_delay_ticks = delay_ticks;
  return std::make_unique<SimulatedDevice>(device, models.patient, travels(device), kLoopPeriod_s);
}

// A spring towards the middle of each axis that takes a tenth of the effort limit at its end, and
// beyond three quarters of the way a wall ten times as stiff.
AxisEffort law(const DeviceModel& device, const AxisPosition& q) {
  AxisEffort effort(q.size());
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    const double half = 0.5 * (axis.upper - axis.lower);
    const double at = (q[a] - axis.lower) / half - 1.0;
    const double in_wall = std::copysign(std::max(0.0, std::abs(at) - 0.75), at);
    effort[a] = -0.1 * axis.effort_limit * (at + 10.0 * in_wall);
  }
  return effort;
}

struct Apart {
  double steps = 0.0;   ///< largest difference of positions [encoder steps]
  double effort = 0.0;  ///< largest difference of efforts [N or N.m]
  double travel = 0.0;  ///< smallest travel of an axis, as a share of its range
};

// Runs both devices and returns their largest differences.
Apart runBoth(const Models& models, HapticDevice& built_in, HapticDevice& other,
              const std::function<void()>& before_read, const std::function<void()>& after_write) {
  Apart apart;
  const int axes = models.device.axisCount();
  AxisPosition lowest(axes, 1e9), highest(axes, -1e9);
  for (int tick = 0; tick < kLockSteps; ++tick) {
    DeviceReading expected, read;
    EXPECT_EQ(built_in.read(expected, 1), Fault::kNone);
    before_read();
    EXPECT_EQ(other.read(read, 1), Fault::kNone) << "tick " << tick;
    const AxisEffort effort = law(models.device, expected.q_m), sent = law(models.device, read.q_m);
    for (int a = 0; a < axes; ++a) {
      const DeviceAxis& axis = models.device.axes[a];
      apart.steps =
          std::max(apart.steps, std::abs(read.q_m[a] - expected.q_m[a]) / axis.encoder_step);
      apart.effort = std::max(apart.effort, std::abs(sent[a] - effort[a]));
      lowest[a] = std::min(lowest[a], expected.q_m[a]);
      highest[a] = std::max(highest[a], expected.q_m[a]);
    }
    EXPECT_EQ(built_in.write(effort), Fault::kNone);
    EXPECT_EQ(other.write(sent), Fault::kNone);
    after_write();
    if (testing::Test::HasFailure()) break;
  }
  apart.travel = 1.0;
  for (int a = 0; a < axes; ++a) {
    const DeviceAxis& axis = models.device.axes[a];
    apart.travel = std::min(apart.travel, (highest[a] - lowest[a]) / (axis.upper - axis.lower));
  }
  return apart;
}

void expectTheSame(const Apart& apart, const std::string& name) {
  figure(name + ", positions apart", apart.steps, "encoder steps");
  figure(name + ", efforts apart", apart.effort, "N or N.m");
  figure(name + ", least travel", apart.travel, "of the range");
  EXPECT_LE(apart.steps, 1.0 + 1e-6);
  EXPECT_LE(apart.effort, kTorqueStep_nm);
  EXPECT_GT(apart.travel, 0.3) << "the patient moves";
}

// The fake's gripper: opening per flexion, and lever from its force to the flexion's effort.
constexpr double kAngleForFlexion = 0.4 / std::numbers::pi, kLever_m = 0.2;
constexpr const char* kLambdaSettings = R"(kind = "force-dimension"
version = 1
delay_s = 0.001
watchdog_s = 0.02
yaw_rad = 3.141592653589793
force_limit_n = 20.0
half_travel_m = 0.12
step_m = 1e-5
[gripper]
axis = "finger_flexion"
open_rad = 0.5
closed_rad = 0.1
flexion_rad = 3.141592653589793
lever_m = 0.2
force_limit_n = 40.0
step_rad = 1e-5
)";

TEST(LockStep, ForceDimension_MatchesTheBuiltInDevice) {
  const Models models = patientOn({"x", "y", "z", "finger_flexion"});
  const auto built_in = plantOf(models, 1), plant = plantOf(models, 1);
  ForceDimensionDriver at;
  const auto device = orThrow(
      PluginDevice::make(orThrow(at.load("", kLambdaSettings)), models.device, kLoopPeriod_s));
  ASSERT_TRUE(built_in->open() && plant->open() && device->open() && device->enable());
  const auto move = [&] {
    DeviceReading reading;
    EXPECT_EQ(plant->read(reading, 1), Fault::kNone);
    at.fake->position_m[0] = -reading.q_m[0];
    at.fake->position_m[1] = -reading.q_m[1];
    at.fake->position_m[2] = reading.q_m[2];
    at.fake->angle_rad = 0.5 - kAngleForFlexion * reading.q_m[3];
  };
  const auto push = [&] {
    AxisEffort effort(4);
    effort[0] = -at.fake->force[0];
    effort[1] = -at.fake->force[1];
    effort[2] = at.fake->force[2];
    effort[3] = -at.fake->force[6] * kLever_m * kAngleForFlexion;
    EXPECT_EQ(plant->write(effort), Fault::kNone);
  };
  expectTheSame(runBoth(models, *built_in, *device, move, push), "Force Dimension");
}

// Sets the motors for given axes, computed by hand as the inverse of the hand settings.
void place(std::vector<FakeDrive>& drives, const AxisPosition& q) {
  drives[0].position_rev = (q[0] - 1.5) / kRev_rad;
  drives[1].position_rev = (1.0 - 1.5 * q[1]) / kRev_rad;
  drives[2].position_rev = (q[2] - 0.4 * q[1] + 0.2) / kRev_rad;
}
AxisEffort pushOf(const std::vector<FakeDrive>& drives) {
  AxisEffort effort(3);
  effort[0] = drives[0].torque_nm();
  effort[2] = drives[2].torque_nm();
  effort[1] = -1.5 * drives[1].torque_nm() - 0.4 * effort[2];
  return effort;
}

// On the bus a command takes a period to arrive and is answered on arrival. The built-in device has
// an output delay of one period, the one behind the bus has none.
TEST(LockStep, Moteus_MatchesTheBuiltInDevice) {
  const Models models = patientOn({"finger_flexion", "thumb_circumduction", "thumb_flexion"});
  const auto built_in = plantOf(models, 1), plant = plantOf(models, 0);
  SimulatedTime time;
  FakeBusState bus;
  for (int id = 1; id <= 3; ++id) bus.drives.emplace_back(id);
  AxisPosition start = travels(models.device).start();
  for (int a = 0; a < start.size(); ++a) {
    const double step = models.device.axes[a].encoder_step;
    start[a] = step * std::round(start[a] / step);
  }
  place(bus.drives, start);
  static const SimulatedTime* clock = nullptr;
  clock = &time;
  const auto device = orThrow(
      PluginDevice::make(std::make_shared<MoteusInStep>(bus, time), models.device, kLoopPeriod_s,
                         std::nullopt, []() noexcept { return std::int64_t{clock->now_ns}; }));
  ASSERT_TRUE(built_in->open() && plant->open() && device->open() && device->enable());
  bus.by_hand = true;
  bus.latency_ns = 0;
  const auto move = [&] {
    time.now_ns += 1'000'000;
    DeviceReading reading;
    EXPECT_EQ(plant->read(reading, 1), Fault::kNone);
    place(bus.drives, reading.q_m);
    bus.deliver(time.now_ns);
    EXPECT_EQ(plant->write(pushOf(bus.drives)), Fault::kNone);
  };
  expectTheSame(runBoth(models, *built_in, *device, move, [] {}), "moteus");
}

}  // namespace
}  // namespace wholehand::test
