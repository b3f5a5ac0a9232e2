// A person at a screen steers the virtual patient's hand; the hand's support may suddenly give way.
#include "files/device/device_file.hpp"
#include "files/patient/patient_file.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/patient/motion.hpp"
#include "loop/patient/steered_player.hpp"
#include "support/player_commands.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

struct LetGo {
  double fastest = 0.0;  ///< largest speed of the axis [rad/s]
  double end = 0.0;      ///< position a second later [rad]
};

/// Holds an axis of the paper's device at `from` with the device's largest effort, against a person
/// who aims at `to`, then releases it at once.
LetGo letGo(const char* name, double from, double to) {
  const std::string config = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
  const auto model = loadDeviceFile(config + "devices/lambda-pride.toml");
  const auto patient = loadPatientFile(config + "patients/relaxed-adult.toml", *model);
  const int axis = model->axisIndex(name);
  AxisPosition at(model->axisCount());
  at[axis] = from;
  auto steered = std::make_unique<SteeredPlayer>(
      std::make_unique<ScriptedPlayer>(Intention::throughWaypoints({{0.0, at}})), *model);
  SteeredPlayer& player = *steered;
  SimulatedDevice device(*model, *patient, std::move(steered), 1e-3);
  EXPECT_TRUE(device.open().ok());
  player.command(test::steer(Steering::kPerson));
  AxisPosition aim = at;
  aim[axis] = to;
  player.command(test::aim(aim));
  TickRecord seen;
  DeviceReading reading;
  LetGo out;
  const double most = model->axes[axis].effort_limit;
  for (int tick = 0; tick < 1600; ++tick) {
    const bool holds = tick < 600;
    AxisEffort effort = model->neutral();
    if (holds) {  // a spring and a damper within the effort limit
      const double ahead = device.position()[axis] - from + 0.02 * device.velocity()[axis];
      effort[axis] -= std::clamp(ahead / 0.05, -1.0, 1.0) * most;
    }
    EXPECT_EQ(device.read(reading, 1), Fault::kNone);
    EXPECT_EQ(device.write(effort), Fault::kNone);
    seen.q_m = reading.q_m;
    player.onRecord(seen);
    if (!holds) out.fastest = std::max(out.fastest, std::abs(device.velocity()[axis]));
  }
  out.end = device.position()[axis];
  return out;
}

// Random aims of a finger on a screen found this: a squeezing hand slipped off a bottle, and the
// stop for excess speed ended the game. The limits are those of the device file.
TEST(SteeredPerson, SupportThatGivesWay_StaysBelowTheSpeedLimit) {
  const LetGo closing = letGo("finger_flexion", 0.4, 2.8);
  EXPECT_LT(closing.fastest, 10.0);
  EXPECT_NEAR(closing.end, 2.8, 0.05) << "the aim is reached all the same";
  EXPECT_LT(letGo("finger_flexion", 2.5, 0.2).fastest, 10.0);
  EXPECT_LT(letGo("thumb_flexion", 0.1, 1.3).fastest, 10.0);
  EXPECT_LT(letGo("x", -0.07, 0.07).fastest, 1.5);
}

// A late tick sees the axis further on, although the axis is no faster.
TEST(SteeredPerson, LateTicks_DoNotChangeTheIntention) {
  constexpr int kLate = 4;
  DeviceModel device;
  DeviceAxis axis;
  axis.lower = -1.0, axis.upper = 1.0, axis.speed_limit = 1.5;
  device.axes = {axis};
  const auto player = [&] {
    auto made = std::make_unique<SteeredPlayer>(
        std::make_unique<ScriptedPlayer>(
            Intention::throughWaypoints({{0.0, AxisPosition(1, 0.0)}})),
        device);
    made->command(test::steer(Steering::kPerson));
    made->command(test::aim(AxisPosition(1, 0.9)));
    return made;
  };
  const auto watched = player(), alone = player();
  AxisPosition q, q_alone;
  AxisVelocity qd;
  for (int tick = 0; tick < 500; ++tick) {
    for (int period = 0; period < kLate; ++period) {
      watched->advance(1e-3, q, qd);
      alone->advance(1e-3, q_alone, qd);
    }
    ASSERT_EQ(q[0], q_alone[0]) << "tick " << tick;
    TickRecord seen;
    seen.elapsed_periods = kLate;
    seen.q_m = q;
    watched->onRecord(seen);
  }
  EXPECT_NEAR(q[0], 0.9, 1e-6);
}

}  // namespace
}  // namespace wholehand
