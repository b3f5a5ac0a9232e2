#include "loop/core/geometry.hpp"
#include "loop/patient/active_patient.hpp"
#include "loop/patient/motion.hpp"
#include "loop/patient/person_tools.hpp"
#include "loop/patient/reach.hpp"
#include "loop/patient/steered_player.hpp"
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

TEST(ScriptedPlayer, AnyPeriod_GivesTheIntentionAtThatTimeBitForBit) {
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

TEST(SteeredPlayer, NobodyTookOver_EqualsTheVirtualPatientBitForBit) {
  SteeredPlayer steered(script(), twoAxes());
  ScriptedPlayer alone(swinging());
  steered.command(aim(pose(0.2, 0.2)));  // a person who only watches
  for (int k = 0; k < 2000; ++k) {
    const Moved a = advanceOf(steered), b = advanceOf(alone);
    ASSERT_EQ(a.q[0], b.q[0]);
    ASSERT_EQ(a.qd[1], b.qd[1]);
  }
}

TEST(SteeredPlayer, AimBeyondTenTimesTheRange_IsReportedWithItsAxis) {
  const DeviceModel device = twoAxes();  // -0.1 to 0.2: ten times 0.3 beyond either end
  EXPECT_EQ(firstFarAim(device, pose(3.19, -3.09)), -1);
  EXPECT_EQ(firstFarAim(device, pose(3.21, 0.0)), 0);
  EXPECT_EQ(firstFarAim(device, pose(0.0, -3.11)), 1);
  EXPECT_EQ(firstFarAim(device, pose(0.0, 1e300)), 1);
}

TEST(SteeredPlayer, AimThatJumps_IsReachedWithinTheSpeedLimitWithoutOvershoot) {
  SteeringConfig config;
  config.speed_share = 0.2;  // 0.3 m/s
  config.grip_past_rad = 0.0;
  SteeredPlayer player(
      std::make_unique<ScriptedPlayer>(Intention::throughWaypoints({{0.0, pose(0.0, 0.0)}})),
      twoAxes(), config);
  player.command(steer(Steering::kPerson));
  player.command(aim(pose(0.12, 9.0)));  // the second is far outside the range
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
      // A ramp of 0.3 m/s is followed with a lag of 2/ω, less the transient of the start: v (t -
      // 2/ω + (t + 2/ω) e^{-ωt}).
      const double w = config.rate_rad_s, t = 0.3;
      EXPECT_NEAR(m.q[0], 0.3 * (t - 2 / w + (t + 2 / w) * std::exp(-w * t)), 0.3 * kPeriod_s);
    }
  }
  EXPECT_NEAR(before, 0.12, 1e-9);  // the hand stays there without a new aim
}

// For a firm grip, fingers may be aimed past the end of their range by as much as the bar's own
// player does.
TEST(SteeredPlayer, FingersAimedFarBeyondTheirRange_StopAtTheGrippingPlayersAngle) {
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

TEST(SteeredPlayer, InvalidAims_AreIgnored) {
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
/// script can cause: no jump when control passes from one to the other.
TEST(SteeredPlayer, ControlPassedAtRandom_IsContinuousInPositionAndVelocity) {
  auto random = seededRandom(31);
  const auto share = [&random] { return static_cast<double>(random() >> 11U) * 0x1.0p-53; };
  SteeredPlayer player(script(), twoAxes());
  Moved before = advanceOf(player);
  // Script: 0.2 over 0.4 s by minimum jerk has at most 5.774 * 0.2 / 0.4² = 7.2. A goal that moves
  // at 0.75 pulls with at most ω v, one that reverses with twice that: 30 for ω = 20, 12 for ω = 8.
  // A takeover in motion adds the speed at that time: 30 + 20 * 1.7.
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

TEST(SteeredPlayer, HandedBack_SoonReachesTheVirtualPatientsAim) {
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

Moved after(Reach& reach, int periods, double period_s = 1e-3) {
  Moved m;
  for (int i = 0; i < periods; ++i) reach.advance(period_s, m.q, m.qd);
  return m;
}

TEST(Reach, FromRest_IsMinimumJerk) {
  Reach reach;
  reach.begin(pose(0.1, 0.0), AxisVelocity(2), pose(0.3, -0.4), 1.0);
  const Moved half = after(reach, 500);
  // Flash and Hogan 1985: halfway at half the time, with the peak speed of 15/8 of the mean.
  EXPECT_NEAR(half.q[0], 0.2, 1e-12);
  EXPECT_NEAR(half.qd[1], -15.0 / 8.0 * 0.4, 1e-12);
  EXPECT_FALSE(reach.done());
  const Moved end = after(reach, 501);
  EXPECT_TRUE(reach.done());
  EXPECT_EQ(end.q[0], 0.3);
  EXPECT_EQ(end.qd[1], 0.0);
}

TEST(Reach, BegunInMotion_KeepsItsSpeedAndComesToRest) {
  Reach reach;
  AxisVelocity going(2);
  going[0] = 0.5;
  reach.begin(pose(0.0, 0.0), going, pose(0.1, 0.0), 0.8);
  Moved before = after(reach, 1);
  EXPECT_NEAR(before.q[0], 0.5e-3, 1e-6);
  EXPECT_NEAR(before.qd[0], 0.5, 2e-3);
  for (int k = 0; k < 900; ++k) {
    const Moved now = after(reach, 1);
    // The error of the trapezoid rule is T³/12 of the jerk, at most a few hundred here.
    ASSERT_NEAR(now.q[0] - before.q[0], 0.5e-3 * (now.qd[0] + before.qd[0]), 1e-7) << k;
    before = now;
  }
  EXPECT_EQ(before.q[0], 0.1);
}

TEST(Reach, AxisWithItsOwnInterval_MovesOnlyThen) {
  Reach reach;
  reach.begin(pose(0.0, 0.0), AxisVelocity(2), pose(1.0, 1.0), 1.0);
  reach.during(0, 0.0, 0.4);
  reach.during(1, 0.6, 1.0);
  const Moved early = after(reach, 400);
  EXPECT_EQ(early.q[0], 1.0);
  EXPECT_EQ(early.q[1], 0.0);
  const Moved late = after(reach, 400);
  EXPECT_NEAR(late.q[1], 0.5, 1e-9);
}

TEST(Reach, LimitedSpeedOfAnAxis_LengthensTheWholeMovement) {
  // Minimum jerk: the peak speed is 15/8 of the mean. 1 rad in 0.4 of the time at 0.5 rad/s.
  Reach reach;
  reach.begin(pose(0.0, 0.0), AxisVelocity(2), pose(-1.0, 1.0), 1.0);
  reach.during(0, 0.0, 0.4);
  reach.limitSpeed(0, 0.5);
  const int whole_ms = static_cast<int>(1e3 * 15.0 / 8.0 / 0.5 / 0.4);
  double fastest = 0.0;
  for (int k = 0; k < whole_ms; ++k) fastest = std::min(fastest, after(reach, 1).qd[0]);
  EXPECT_NEAR(fastest, -0.5, 1e-6);
  const Moved end = after(reach, 2);
  EXPECT_TRUE(reach.done());
  EXPECT_EQ(end.q[1], 1.0);
  reach.begin(pose(0.0, 0.0), AxisVelocity(2), pose(1.0, 1.0), 1.0);
  reach.limitSpeed(0, std::numeric_limits<double>::infinity());
  (void)after(reach, 1000);
  EXPECT_TRUE(reach.done());
}

TEST(Waypoints, BetweenTwo_FollowFlashAndHogan) {
  // Flash and Hogan 1985: halfway at half the time, with the peak speed of 15/8 of the mean.
  const Intention way =
      Intention::throughWaypoints({{1.0, pose(0.1, -2.0)}, {3.0, pose(0.3, 0.0)}});
  AxisPosition q;
  AxisVelocity qd;
  way.evaluate(2.0, q, qd);
  EXPECT_NEAR(q[0], 0.2, 1e-15);
  EXPECT_NEAR(q[1], -1.0, 1e-15);
  EXPECT_NEAR(qd[0], 15.0 / 8.0 * 0.1, 1e-15);
  way.evaluate(1.5, q, qd);
  // 10/64 - 15/256 + 6/1024 of the way at a quarter of the time
  EXPECT_NEAR(q[0], 0.1 + 0.2 * (10.0 / 64 - 15.0 / 256 + 6.0 / 1024), 1e-15);
  EXPECT_NEAR(qd[0], 0.2 / 2.0 * 30.0 * (0.25 * 0.25) * (0.75 * 0.75), 1e-15);
}

TEST(Waypoints, BeforeStartAtPointsAndAfterEnd_AreAtRest) {
  const Intention way = Intention::throughWaypoints(
      {{0.5, pose(0.1, 1.0)}, {1.0, pose(0.2, 2.0)}, {1.25, pose(-0.1, 0.5)}});
  EXPECT_EQ(way.duration_s(), 1.25);
  EXPECT_EQ(way.start()[1], 1.0);
  AxisPosition q;
  AxisVelocity qd;
  for (const auto& [time_s, first] :
       {std::pair{-1.0, 0.1}, {0.0, 0.1}, {0.5, 0.1}, {1.0, 0.2}, {1.25, -0.1}, {1e9, -0.1}}) {
    way.evaluate(time_s, q, qd);
    EXPECT_NEAR(q[0], first, 1e-15) << time_s;
    EXPECT_NEAR(qd[0], 0.0, 1e-15) << time_s;
    EXPECT_EQ(qd.size(), 2);
  }
}

TEST(Waypoints, Velocity_IsTheSlopeOfPosition) {
  const Intention way = Intention::throughWaypoints(
      {{0.0, pose(0.0, 1.0)}, {0.4, pose(0.2, 2.0)}, {1.0, pose(-0.1, 0.5)}});
  AxisPosition before, after, q;
  AxisVelocity qd, ignored;
  for (double t_s = 0.01; t_s < 1.0; t_s += 0.0137) {
    way.evaluate(t_s - 1e-6, before, ignored);
    way.evaluate(t_s + 1e-6, after, ignored);
    way.evaluate(t_s, q, qd);
    for (int k = 0; k < 2; ++k) {
      ASSERT_NEAR(qd[k], (after[k] - before[k]) / 2e-6, 1e-6) << t_s;  // central difference
    }
  }
}

TEST(VirtualPatient, Impedance_PullsTowardsTheAimAndBrakesAgainstIt) {
  const PatientAxis person{"x", 0.5, 8.0, 135.0};
  // Spring and dashpot, each alone and together: 135·0.01 = 1.35 N, 8·(-0.2) = -1.6 N.
  EXPECT_DOUBLE_EQ(impedanceEffort(person, 0.02, 0.0, 0.03, 0.0), 135.0 * (0.03 - 0.02));
  EXPECT_DOUBLE_EQ(impedanceEffort(person, 0.0, 0.3, 0.0, 0.1), 8.0 * (0.1 - 0.3));
  EXPECT_NEAR(impedanceEffort(person, 0.02, 0.3, 0.03, 0.1), 1.35 - 1.6, 1e-12);
}

TEST(VirtualPatient, EveryAxis_HasItsOwnImpedance) {
  PatientConfig patient;
  patient.axes = {{"x", 0.5, 0.0, 100.0}, {"finger_flexion", 0.0, 2.0, 0.0}};
  const AxisEffort effort = patientEffort(patient, pose(0.0, 0.0), AxisVelocity(2, 1.0),
                                          pose(0.1, 9.0), AxisVelocity(2, 0.0));
  EXPECT_EQ(effort.size(), 2);
  EXPECT_DOUBLE_EQ(effort[0], 10.0);
  EXPECT_DOUBLE_EQ(effort[1], -2.0);
}

}  // namespace
}  // namespace wholehand::test
