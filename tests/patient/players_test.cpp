#include "core/units.hpp"
#include "patient/person_tools.hpp"
#include "patient/scripted_player.hpp"
#include "patient/steered_player.hpp"
#include "support/constants.hpp"
#include "support/player_commands.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

DeviceModel twoAxes() {
  DeviceModel device;
  for (const char* name : {"x", "finger_flexion"}) {
    DeviceAxis axis;
    axis.name = name;
    axis.lower = -0.1;
    axis.upper = 0.2;
    axis.speed_limit = 1.5;
    device.axes.push_back(axis);
  }
  return device;
}

Intention swinging() {
  std::vector<Waypoint> points;
  for (int i = 0; i < 40; ++i) {
    points.push_back({0.4 * i, i % 2 == 0 ? pose(-0.05, 0.15) : pose(0.1, -0.05)});
  }
  return Intention::throughWaypoints(points);
}

std::unique_ptr<Player> script() {
  return std::make_unique<ScriptedPlayer>(swinging());
}

Moved advanceOf(Player& player, int periods = 1) {
  Moved m;
  for (int i = 0; i < periods; ++i) player.advance(kPeriod_s, m.q, m.qd);
  return m;
}

TEST(ScriptedPlayer, AnyPeriod_IsTheIntentionAtThatTimeBitForBit) {
  const Intention way = swinging();
  ScriptedPlayer player(way);
  for (int run = 0; run < 2; ++run) {
    player.reset();
    EXPECT_EQ(player.start()[0], way.start()[0]);
    for (int k = 1; k <= 3000; ++k) {
      const Moved m = advanceOf(player);
      Moved expected;
      way.evaluate(static_cast<double>(k) * kPeriod_s, expected.q, expected.qd);
      ASSERT_EQ(m.q[0], expected.q[0]);
      ASSERT_EQ(m.qd[1], expected.qd[1]);
    }
  }
}

TEST(SteeredPlayer, NobodyTookOver_IsTheVirtualPatientBitForBit) {
  SteeredPlayer steered(script(), twoAxes());
  ScriptedPlayer alone(swinging());
  steered.command(aim(pose(0.2, 0.2)));  // a person who only watches
  for (int k = 0; k < 2000; ++k) {
    const Moved a = advanceOf(steered), b = advanceOf(alone);
    ASSERT_EQ(a.q[0], b.q[0]);
    ASSERT_EQ(a.qd[1], b.qd[1]);
  }
}

TEST(SteeredPlayer, AimThatJumps_IsReachedWithinTheSpeedLimitAndWithoutOvershoot) {
  SteeringConfig config;
  config.speed_share = 0.2;  // 0.3 m/s
  config.grip_past_rad = 0.0;
  SteeredPlayer player(
      std::make_unique<ScriptedPlayer>(Intention::throughWaypoints({{0.0, pose(0.0, 0.0)}})),
      twoAxes(), config);
  player.command(steer(Steering::kPerson));
  player.command(aim(pose(0.12, 9.0)));  // the second far outside the range
  double before = 0.0;
  for (int k = 0; k < 2000; ++k) {
    const Moved m = advanceOf(player);
    ASSERT_LE(m.qd[0], 0.3 * (1 + 1e-12));
    ASSERT_LE(m.qd[1], 0.3 * (1 + 1e-12));
    ASSERT_GE(m.q[0], before);
    before = m.q[0];
    ASSERT_LE(m.q[0], 0.12);
    ASSERT_LE(m.q[1], 0.2);  // the end of the range
    if (k == 300 - 1) {
      // A ramp of 0.3 m/s is followed 2/ω behind, less what the start still weighs:
      // v (t - 2/ω + (t + 2/ω) e^{-ωt}).
      const double w = config.rate_rad_s, t = 0.3;
      EXPECT_NEAR(m.q[0], 0.3 * (t - 2 / w + (t + 2 / w) * std::exp(-w * t)), 0.3 * kPeriod_s);
    }
  }
  EXPECT_NEAR(before, 0.12, 1e-9);  // and held there while no aim comes
}

// A firm grip: fingers may be aimed past the end of their range, by as much as the bar's own player
// does.
TEST(SteeredPlayer, FingersAimedFarBeyondTheirRange_StopAtTheSameAngleAsAPlayerThatGrips) {
  DeviceModel device = twoAxes();
  SteeredPlayer player(
      std::make_unique<ScriptedPlayer>(Intention::throughWaypoints({{0.0, pose(0.0, 0.0)}})),
      device);
  player.command(steer(Steering::kPerson));
  player.command(aim(pose(9.0, 9.0)));
  const Moved m = advanceOf(player, 20'000);
  EXPECT_NEAR(m.q[0], device.axes[0].upper, 1e-9);
  EXPECT_NEAR(m.q[1], device.axes[1].upper + 30.0 * kDeg, 1e-9);
}

TEST(SteeredPlayer, AimsThatAreNone_AreIgnored) {
  SteeredPlayer player(script(), twoAxes());
  player.command(steer(Steering::kPerson));
  player.command(aim(pose(0.05, 0.05)));
  player.command(aim(AxisPosition(5, 0.1)));
  player.command(aim(pose(std::numeric_limits<double>::quiet_NaN(), 0.1)));
  const Moved m = advanceOf(player, 3000);
  EXPECT_NEAR(m.q[0], 0.05, 1e-9);
  EXPECT_NEAR(m.q[1], 0.05, 1e-9);
}

/// Position is the sum of velocity, and velocity changes by no more than the two filters and the
/// script may ask for: no jump when the hand goes from one to the other.
TEST(SteeredPlayer, SteeringThatChangesHandsAtRandom_IsContinuousInPositionAndVelocity) {
  auto random = seededRandom(31);
  const auto share = [&random] { return static_cast<double>(random() >> 11U) * 0x1.0p-53; };
  SteeredPlayer player(script(), twoAxes());
  Moved before = advanceOf(player);
  // Script: 0.2 over 0.4 s by minimum jerk: at most 5.774 * 0.2 / 0.4² = 7.2. A goal that moves at
  // 0.75 pulls with at most ω v, one that reverses with twice that: 30 for ω = 20, 12 for ω = 8;
  // taken over on the way, what was there adds to it: 30 + 20 * 1.7.
  constexpr double kMost = 70.0;
  for (int k = 0; k < 12000; ++k) {
    if (share() < 0.004) {
      player.command(steer(share() < 0.5 ? Steering::kPerson : Steering::kVirtualPatient));
    }
    if (share() < 0.01) player.command(aim(pose(-0.3 + 0.8 * share(), -0.3 + 0.8 * share())));
    const Moved now = advanceOf(player);
    for (int i = 0; i < 2; ++i) {
      ASSERT_NEAR(now.q[i] - before.q[i], 0.5 * kPeriod_s * (now.qd[i] + before.qd[i]),
                  kMost * kPeriod_s * kPeriod_s)
          << "period " << k;
      ASSERT_LE(std::abs(now.qd[i] - before.qd[i]), kMost * kPeriod_s) << "period " << k;
    }
    before = now;
  }
}

TEST(SteeredPlayer, HandedBack_IsWhereTheVirtualPatientWantsToBeSoon) {
  SteeredPlayer player(
      std::make_unique<ScriptedPlayer>(Intention::throughWaypoints({{0.0, pose(0.1, 0.1)}})),
      twoAxes());
  player.command(steer(Steering::kPerson));
  player.command(aim(pose(-0.1, 0.0)));
  ASSERT_NEAR(advanceOf(player, 2000).q[0], -0.1, 1e-9);
  EXPECT_EQ(player.steering(), Steering::kPerson);
  player.command(steer(Steering::kVirtualPatient));
  EXPECT_NEAR(advanceOf(player).q[0], -0.1, 1e-5);  // not at once
  EXPECT_NEAR(advanceOf(player, 2500).q[0], 0.1, 1e-6);
  player.reset();
  EXPECT_EQ(advanceOf(player).q[0], 0.1);
}

}  // namespace
}  // namespace wholehand::test
