// What a person does of their own accord on several axes at once: a tremor along a direction, and
// reflexes of which one triggers all.
#include "patient/active_patient.hpp"
#include "patient/person_tools.hpp"
#include "support/constants.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

DeviceModel threeDigits() {
  return digits({"finger_flexion", "thumb_circumduction", "thumb_flexion"});
}

PatientInput felt(const AxisPosition& q, const AxisVelocity& qd) {
  return {q, qd, AxisEffort(3), AxisEffort(3)};
}

/// A u sin(2πft + φ): all axes pass zero together, and the direction is u in every tick.
TEST(TremorAlong, AllAxes_SwingAlongTheDirectionInOnePhase) {
  PatientConfig patient = calm(3);
  patient.tremor.along = AxisEffort(3);
  patient.tremor.along[0] = 0.08;
  patient.tremor.along[2] = -0.06;
  ActivePatient person(patient, threeDigits(), kPeriod_s);
  double largest = 0.0;
  for (int k = 0; k < 400; ++k) {
    ASSERT_NEAR(person.end()[2], -0.75 * person.end()[0], tolerance(1e-15));
    ASSERT_EQ(person.end()[1], 0.0);
    largest = std::max(largest, std::abs(person.end()[0]));
    person.advance(felt(AxisPosition(3), AxisVelocity(3)));
  }
  // Two turns of 5 Hz, looked at 200 times each: the top is missed by 1 - cos(π / 200) at most.
  EXPECT_LE(largest, 0.08);
  EXPECT_GE(largest, 0.08 * std::cos(std::numbers::pi / 200.0));
}

TEST(TremorAlong, PhasesOfSingleAxes_AreWhatTheyWereWithoutIt) {
  PatientConfig alone = calm(3), both = calm(3);
  alone.axes[1].tremor = both.axes[1].tremor = 0.05;
  both.tremor.along = AxisEffort(3);
  both.tremor.along[0] = 0.1;
  const ActivePatient one(alone, threeDigits(), kPeriod_s), other(both, threeDigits(), kPeriod_s);
  EXPECT_EQ(one.end()[1], other.end()[1]);  // bit for bit: old recordings replay
}

PatientConfig fist(bool together) {
  PatientConfig patient = calm(3);
  patient.axes[0].reflex = {0.3, 1.0, 2.0};
  patient.axes[2].reflex = {0.1, 2.0, 1.2};
  patient.reflex = {.delay_s = 0.04, .muscle_lag_s = 0.03, .largest_triggers_all = together};
  return patient;
}

/// Fingers opened at 3 rad/s, thumb at rest at 0.2 rad, for long.
AxisEffort caught(bool together) {
  ActivePatient person(fist(together), threeDigits(), kPeriod_s);
  AxisPosition q(3, 0.2);
  AxisVelocity qd(3);
  qd[0] = -3.0;
  for (int k = 0; k < 1000; ++k) person.advance(felt(q, qd));
  return person.end();
}

/// In the end the muscle holds what it is asked for: g (v - v_th) (s_th - q), v - v_th = 2 rad/s of
/// the fingers for all digits.
TEST(SpasticFist, FingersOpened_MakeTheThumbCatchToo) {
  const AxisEffort alone = caught(false), together = caught(true);
  EXPECT_NEAR(alone[0], 0.3 * 2.0 * 1.8, tolerance(1e-9));
  EXPECT_EQ(alone[2], 0.0);
  EXPECT_EQ(together[0], alone[0]);  // bit for bit
  EXPECT_NEAR(together[2], 0.1 * 2.0 * 1.0, tolerance(1e-9));
  EXPECT_EQ(together[1], 0.0);  // has no reflex
}

TEST(SpasticFist, SlowOpening_CatchesNothing) {
  ActivePatient person(fist(true), threeDigits(), kPeriod_s);
  AxisVelocity qd(3);
  qd[0] = -0.99;  // below 1 rad/s
  qd[1] = -9.0;   // no reflex there
  qd[2] = -1.99;  // below 2 rad/s
  for (int k = 0; k < 500; ++k) person.advance(felt(AxisPosition(3, 0.2), qd));
  for (const double effort : person.end()) EXPECT_EQ(effort, 0.0);
}

}  // namespace
}  // namespace wholehand::test
