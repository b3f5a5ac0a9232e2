// The climb to the effort limit: its pushes and their comparison with a prediction.
#include "devices/commissioning/climb.hpp"

#include "devices/commissioning/identification/drive_lag.hpp"
#include "files/device/device_file.hpp"
#include "mechanism.hpp"
#include "support/seed.hpp"
#include "support/shipped.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace wholehand::test {
namespace {

std::vector<DeviceAxis> shippedAxes() {
  std::vector<DeviceAxis> out;
  for (const std::string& device : shipped("devices")) {
    const DeviceModel model =
        orThrow(loadDeviceFile(WHOLEHAND_SOURCE_DIR "/config/devices/" + device + ".toml"));
    out.insert(out.end(), model.axes.begin(), model.axes.end());
  }
  return out;
}

// By its definition: integrals of the shape, and the limits of the device files.
TEST(Climb, PushOfEveryShippedAxis_KeepsSpeedRangeAndSlewAndComesBack) {
  for (const DeviceAxis& axis : shippedAxes()) {
    const double length_s = pushLength_s(axis, axis.mass);
    constexpr int kParts = 20'000;
    double v = 0.0, q = 0.0, fastest = 0.0, farthest = 0.0, steepest = 0.0, largest = 0.0;
    for (int k = 0; k < kParts; ++k) {
      const double h = length_s / kParts;
      const double now = axis.effort_limit * pushShape((k + 0.5) / kParts);
      const double before = axis.effort_limit * pushShape((k - 0.5) / kParts);
      steepest = std::max(steepest, std::abs(now - before) / h);
      largest = std::max(largest, std::abs(now));
      v += h * now / axis.mass;
      q += h * v;
      fastest = std::max(fastest, std::abs(v));
      farthest = std::max(farthest, std::abs(q));
    }
    SCOPED_TRACE(axis.name);
    EXPECT_NEAR(largest, axis.effort_limit, 1e-6 * axis.effort_limit);
    EXPECT_LT(fastest, 0.9 * axis.speed_limit);
    EXPECT_LT(farthest, 0.2 * (axis.upper - axis.lower));
    EXPECT_LT(steepest, axis.effort_slew_limit);
    EXPECT_LT(std::abs(v), 1e-3 * fastest) << "at rest";
    EXPECT_LT(std::abs(q), 1e-2 * farthest) << "where it was";
  }
}

/// The response of a mechanism, an independent simulation, whose motor gives `gain` times what is
/// sent, and no more than `most`.
PushResponse pushed(const DeviceAxis& axis, double share, double gain, double most) {
  MechanismAxis m;
  m.mass = axis.mass;
  m.damping = axis.damping;
  m.coulomb = axis.coulomb;
  m.lower = -10.0;
  m.upper = 10.0;
  m.step = axis.encoder_step;
  m.delay_s = 1.3e-3;
  Mechanism mechanism({m}, 1e-3);
  const double length_s = pushLength_s(axis, axis.mass);
  std::vector<double> position, effort;
  for (int k = 0; 1e-3 * k < length_s + 0.02; ++k) {
    position.push_back(mechanism.position(0));
    effort.push_back(share * axis.effort_limit * pushShape(1e-3 * k / length_s));
    mechanism.advance({std::clamp(gain * effort.back(), -most, most)});
  }
  return comparePush(position, effort, 1e-3, {axis.mass, axis.damping, axis.coulomb, 1.3e-3});
}

TEST(Climb, ResponseOfAnHonestAxis_AgreesAtEveryShare) {
  for (const DeviceAxis& axis : shippedAxes()) {
    for (const double share : kClimbShares) {
      const PushResponse seen = pushed(axis, share, 1.0, HUGE_VAL);
      EXPECT_NEAR(seen.gain, 1.0, 0.1) << axis.name << " at " << share;
      EXPECT_LT(seen.apart, 0.1) << axis.name << " at " << share;
    }
  }
}

TEST(Climb, ThriceTheEffortOrHalfTheLimit_ShowInTheResponse) {
  for (const DeviceAxis& axis : shippedAxes()) {
    EXPECT_GT(pushed(axis, 0.4, 3.0, HUGE_VAL).gain, 2.0) << axis.name;
    EXPECT_LT(pushed(axis, 0.4, -1.0, HUGE_VAL).gain, 0.0) << axis.name;
    const PushResponse clipped = pushed(axis, 1.0, 1.0, 0.5 * axis.effort_limit);
    EXPECT_TRUE(clipped.gain < 1.0 / 1.3 || clipped.apart > 0.25)
        << axis.name << ": " << clipped.gain << ", " << clipped.apart;
  }
}

// The measured effort of a drive of first order, by its exact solution.
TEST(DriveLag, OfADriveOfFirstOrder_IsWithinTheInterval) {
  auto random = seededRandom(5806);
  for (int i = 0; i < cases(30); ++i) {
    const double lag_s = uniform(random, 0.5e-3, 8e-3), gain = uniform(random, 0.9, 1.1);
    const int delay = static_cast<int>(random() % 3);
    std::vector<double> effort, given;
    double y = 0.0, u = 0.0;
    for (int k = 0; k < 3000; ++k) {
      if (random() % 10 == 0) u = uniform(random, -1.0, 1.0);
      given.push_back(y + uniform(random, -0.01, 0.01));
      effort.push_back(u);
      const double acts = k < delay ? 0.0 : effort[static_cast<std::size_t>(k - delay)];
      y += (1.0 - std::exp(-1e-3 / lag_s)) * (gain * acts - y);
    }
    const Interval found = identifyDriveLag(effort, given, 1e-3);
    EXPECT_LE(found.lower, lag_s) << delay;
    EXPECT_GE(found.upper, lag_s) << delay;
    EXPECT_LE(found.upper, 1.5 * lag_s + 0.5e-3) << delay;
  }
}

TEST(DriveLag, WithoutMeasuredEffort_IsUnknown) {
  const std::vector<double> effort(1000, 1.0);
  EXPECT_EQ(identifyDriveLag(effort, std::vector<double>(1000, std::nan("")), 1e-3).upper, 0.0);
}

}  // namespace
}  // namespace wholehand::test
