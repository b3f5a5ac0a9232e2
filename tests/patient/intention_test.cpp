#include "patient/motion.hpp"
#include "patient/person_tools.hpp"
#include "patient/virtual_patient.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

TEST(Waypoints, BetweenTwo_FollowFlashAndHogan) {
  // Flash and Hogan 1985: half way at half time, peak speed 15/8 of the mean, there.
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
  // Hooke and a dashpot, each alone and both: 135·0.01 = 1.35 N, 8·(-0.2) = -1.6 N.
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
