// A patient's own efforts, compared with closed forms.
#include "files/shipped_models.hpp"
#include "loop/patient/active_patient.hpp"
#include "loop/patient/person_tools.hpp"
#include "support/constants.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace wholehand::test {
namespace {

DeviceModel fingers() {
  return digits({"finger_flexion", "thumb_flexion"});
}

PatientInput felt(double q, double qd, double rendered = 0.0, double impedance = 0.0) {
  return {AxisPosition(2, q), AxisVelocity(2, qd), AxisEffort(2, rendered),
          AxisEffort(2, impedance)};
}

TEST(ActivePatient, WithoutHabits_DoesNothingAndKeepsHolding) {
  ActivePatient person(calmPatient(2), fingers(), kPeriod_s);
  EXPECT_FALSE(person.mayLetGo());
  for (int k = 0; k < 100; ++k) {
    person.advance(felt(0.1 * k, 5.0, 1e3, 1e6));
    ASSERT_EQ(person.begin()[0], 0.0);
    ASSERT_EQ(person.end()[1], 0.0);
    ASSERT_TRUE(person.holds(0) && person.holds(1));
  }
}

// ---- tremor

PatientConfig trembling(std::uint64_t phase_seed) {
  PatientConfig patient = calmPatient(2);
  patient.axes[0].tremor = 0.08;
  patient.axes[1].tremor = 0.05;
  patient.tremor.frequency_hz = 6.0;
  patient.tremor.phase_seed = phase_seed;
  return patient;
}

TEST(Tremor, AfterAnyTime_IsASinusoidWithoutStepsOnEachAxis) {
  ActivePatient person(trembling(3), fingers(), kPeriod_s);
  double square = 0.0, at_quarter = 0.0, last = person.end()[0];
  constexpr int kTicks = 3000;  // 18 cycles of 6 Hz
  for (int k = 1; k <= kTicks; ++k) {
    person.advance(felt(0.0, 0.0));
    ASSERT_EQ(person.begin()[0], last);
    last = person.end()[0];
    square += last * last;
    at_quarter += last * person.end()[1];
  }
  EXPECT_NEAR(square / kTicks, 0.5 * 0.08 * 0.08, 1e-12);  // A²/2 over whole cycles
  // The correlation of the axes is the cosine of their phase difference: they do not share one
  // phase.
  EXPECT_LT(std::abs(at_quarter / kTicks), 0.95 * 0.5 * 0.08 * 0.05);
}

TEST(Tremor, PhaseSeed_SetsOnlyThePhases) {
  ActivePatient a(trembling(7), fingers(), kPeriod_s), b(trembling(7), fingers(), kPeriod_s),
      c(trembling(8), fingers(), kPeriod_s);
  EXPECT_EQ(a.end()[0], b.end()[0]);
  EXPECT_NE(a.end()[0], c.end()[0]);
  for (int k = 0; k < 500; ++k) a.advance(felt(0.0, 0.0));
  a.reset();
  EXPECT_EQ(a.end()[0], b.end()[0]);
}

// ---- spastic catch

PatientConfig spastic(double gain = 0.3) {
  PatientConfig patient = calmPatient(2);
  patient.axes[0].reflex = {gain, 60.0 * kDeg, 2.0};
  patient.reflex = {0.04, 0.03};
  return patient;
}

/// Reflex effort after `seconds` of opening at a constant speed from t = 0, starting where the
/// reflex begins.
double pulledAfter(double seconds, double speed_rad_s, double period_s) {
  ActivePatient person(spastic(), fingers(), period_s);
  for (int k = 0; k < std::lround(seconds / period_s); ++k) {
    person.advance(felt(2.0 - speed_rad_s * k * period_s, -speed_rad_s));
  }
  return person.end()[0];
}

TEST(SpasticCatch, OpenedAtConstantSpeed_FollowsTheClosedFormAfterTheDelay) {
  constexpr double kSpeed = 3.0, kDelay_s = 0.04, kLag_s = 0.03;
  EXPECT_EQ(pulledAfter(0.0395, kSpeed, 1e-4), 0.0);
  for (const double t_s : {0.06, 0.1, 0.2}) {
    // u = a + c s from s = t - delay on; τ' = (u - τ)/L gives
    // τ = a (1 - e^(-s/L)) + c (s - L (1 - e^(-s/L))).
    const double s = t_s - kDelay_s, c = 0.3 * (kSpeed - 60.0 * kDeg) * kSpeed;
    const double a = c * kDelay_s, risen = 1.0 - std::exp(-s / kLag_s);
    const double expected = a * risen + c * (s - kLag_s * risen);
    EXPECT_NEAR(pulledAfter(t_s, kSpeed, 1e-4), expected, 0.01 * expected) << t_s;
    EXPECT_NEAR(pulledAfter(t_s, kSpeed, 1e-3), expected, 0.06 * expected) << t_s;
  }
}

TEST(SpasticCatch, SlowOpeningClosingOrBeyondTheAngle_DoesNotTrigger) {
  EXPECT_EQ(pulledAfter(0.3, 59.0 * kDeg, kPeriod_s), 0.0);
  EXPECT_GT(pulledAfter(0.3, 70.0 * kDeg, kPeriod_s), 0.0);
  EXPECT_EQ(reflexDrive({0.3, 1.0, 2.0}, 1.0, 3.0), 0.0);   // closing
  EXPECT_EQ(reflexDrive({0.3, 1.0, 2.0}, 2.1, -3.0), 0.0);  // more flexed than the threshold
  EXPECT_EQ(reflexDrive({0.3, 1.0, 2.0}, 1.5, -3.0), 0.3 * 2.0 * 0.5);
}

TEST(SpasticCatch, OpeningThatStops_PullsForTheDelayThenFadesWithTheMuscle) {
  ActivePatient person(spastic(), fingers(), kPeriod_s);
  for (int k = 0; k < 200; ++k) person.advance(felt(2.0 - 3.0 * k * kPeriod_s, -3.0));
  const double caught = person.end()[0];
  for (int k = 0; k < 40; ++k) person.advance(felt(1.4, 0.0));
  const double late = person.end()[0];
  EXPECT_GT(late, 0.9 * caught);  // the device stands and the person still pulls: an active effort
  for (int k = 0; k < 30; ++k) person.advance(felt(1.4, 0.0));
  EXPECT_NEAR(person.end()[0], late * std::exp(-1.0), 1e-12);  // one lag later
  EXPECT_EQ(person.end()[1], 0.0);                             // the thumb has no reflex here
}

// ---- fight

TEST(Fight, EveryMotionAndEffort_IsAnsweredWithTheFullStrength) {
  EXPECT_EQ(fightEffort(0.4, 0.1, -3.0, 0.1), -0.4);  // with the motion
  EXPECT_EQ(fightEffort(0.4, 0.1, 3.0, 0.1), 0.4);
  EXPECT_EQ(fightEffort(0.4, 0.1, 0.09, 0.1), -0.4);  // at rest: against the device
  EXPECT_EQ(fightEffort(0.4, -0.1, -0.09, 0.1), 0.4);
  EXPECT_EQ(fightEffort(0.4, 0.0, 0.0, 0.1), 0.4);
}

TEST(Fight, ReactionTime_DelaysTheAnswer) {
  PatientConfig patient = calmPatient(2);
  patient.axes[0].fight = 0.4;
  patient.fight_reaction_s = 0.02;
  ActivePatient person(patient, fingers(), kPeriod_s);
  int turned_at = -1;
  for (int k = 0; k < 50; ++k) {
    person.advance(felt(1.0, 0.0, k < 10 ? -1.0 : 1.0));
    ASSERT_EQ(person.begin()[0], person.end()[0]);  // constant over the period
    ASSERT_EQ(std::abs(person.end()[0]), 0.4);
    if (turned_at < 0 && person.end()[0] < 0.0) turned_at = k;
  }
  EXPECT_EQ(turned_at, 10 + 20);
}

TEST(ActivePatient, AllHabitsTogether_StayWithinTheDevicesLimit) {
  PatientConfig patient = trembling(1);
  patient.axes[0].tremor = 10.0;
  patient.axes[0].fight = 50.0;
  patient.axes[0].reflex = {100.0, 0.0, 3.0};
  ActivePatient person(patient, fingers(), kPeriod_s);
  double most = 0.0;
  for (int k = 0; k < 1000; ++k) {
    person.advance(felt(1.0, -8.0, k % 100 < 50 ? 1.0 : -1.0));
    most = std::max({most, std::abs(person.begin()[0]), std::abs(person.end()[0])});
  }
  EXPECT_EQ(most, 2.0);
}

// ---- letting go

/// The impedance's effort is limited to the strength at any speed and is unchanged below it.
TEST(Strength, AnyIntention_PullsNoHarder) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  PatientAxis person;
  int held = 0;
  for (int k = 0; k < 1000; ++k) {
    person.stiffness = k % 3 == 0 ? 0.0 : 100.0;
    person.damping = 5.0;
    person.strength = 0.5;
    const double q = unit(random), qd = unit(random), meant = q + 0.01 * unit(random),
                 speed = qd + 0.2 * unit(random);
    const Pull pull = pullOf(person, q, qd, meant, speed);
    const double wanted = impedanceEffort(person, q, qd, meant, speed);
    const double effort = impedanceEffort(person, q, qd, pull.q, pull.qd);
    EXPECT_NEAR(effort, std::clamp(wanted, -0.5, 0.5), 1e-12);
    held += std::abs(wanted) > 0.5 ? 1 : 0;
  }
  EXPECT_GT(held, 100);
}

/// The opening speed that triggers no catch is the lowest threshold; a healthy hand has none.
TEST(SpasticCatch, UncaughtOpeningSpeed_IsTheLowestThreshold) {
  EXPECT_EQ(reflexFreeOpeningSpeed(patientNamed("spastic")), 1.0);
  EXPECT_EQ(reflexFreeOpeningSpeed(patientNamed("relaxed-adult")),
            std::numeric_limits<double>::infinity());
}

TEST(LettingGo, AfterItsTime_NoEffortOfThePersonIsLeft) {
  PatientConfig patient = trembling(1);
  patient.letting_go.after_s = 0.25;
  ActivePatient person(patient, fingers(), kPeriod_s);
  EXPECT_TRUE(person.mayLetGo());
  for (int k = 0; k < 400; ++k) {
    person.advance(felt(1.0, 0.0));
    ASSERT_EQ(person.hasLetGo(), k >= 250) << k;
    ASSERT_EQ(person.holds(1), k < 250) << k;
    ASSERT_EQ(person.end()[0] == 0.0, k >= 250) << k;
  }
  person.reset();
  EXPECT_FALSE(person.hasLetGo());
}

TEST(LettingGo, AboveItsEffort_IsPermanent) {
  PatientConfig patient = calmPatient(2);
  patient.letting_go.effort_share = 0.5;  // 1 N·m
  ActivePatient person(patient, fingers(), kPeriod_s);
  person.advance(felt(1.0, 0.0, 0.0, 0.99));
  EXPECT_FALSE(person.hasLetGo());
  person.advance(felt(1.0, 0.0, 0.0, -1.01));
  EXPECT_TRUE(person.hasLetGo());
  person.advance(felt(1.0, 0.0, 0.0, 0.0));
  EXPECT_TRUE(person.hasLetGo());
}

// A person's own efforts on several axes at once: a tremor along a direction, and reflexes that one
// axis triggers for all.

DeviceModel threeDigits() {
  return digits({"finger_flexion", "thumb_circumduction", "thumb_flexion"});
}

PatientInput felt(const AxisPosition& q, const AxisVelocity& qd) {
  return {q, qd, AxisEffort(3), AxisEffort(3)};
}

/// A u sin(2πft + φ): all axes pass zero together, and the direction is u in every tick.
TEST(TremorAlong, AllAxes_SwingAlongTheDirectionInOnePhase) {
  PatientConfig patient = calmPatient(3);
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
  // Two cycles of 5 Hz with 200 samples each: the peak is missed by 1 - cos(π / 200) at most.
  EXPECT_LE(largest, 0.08);
  EXPECT_GE(largest, 0.08 * std::cos(std::numbers::pi / 200.0));
}

TEST(TremorAlong, PhasesOfSingleAxes_DoNotChange) {
  PatientConfig alone = calmPatient(3), both = calmPatient(3);
  alone.axes[1].tremor = both.axes[1].tremor = 0.05;
  both.tremor.along = AxisEffort(3);
  both.tremor.along[0] = 0.1;
  const ActivePatient one(alone, threeDigits(), kPeriod_s), other(both, threeDigits(), kPeriod_s);
  EXPECT_EQ(one.end()[1], other.end()[1]);  // bit for bit: old recordings replay
}

PatientConfig fist(bool together) {
  PatientConfig patient = calmPatient(3);
  patient.axes[0].reflex = {0.3, 1.0, 2.0};
  patient.axes[2].reflex = {0.1, 2.0, 1.2};
  patient.reflex = {.delay_s = 0.04, .muscle_lag_s = 0.03, .largest_triggers_all = together};
  return patient;
}

/// Settled reflex efforts with the fingers opened at 3 rad/s and the thumb at rest at 0.2 rad.
AxisEffort caught(bool together) {
  ActivePatient person(fist(together), threeDigits(), kPeriod_s);
  AxisPosition q(3, 0.2);
  AxisVelocity qd(3);
  qd[0] = -3.0;
  for (int k = 0; k < 1000; ++k) person.advance(felt(q, qd));
  return person.end();
}

/// The settled muscle effort is g (v - v_th) (s_th - q); v - v_th = 2 rad/s is that of the fingers
/// for all digits.
TEST(SpasticFist, FingersOpened_TriggerTheThumbsReflexToo) {
  const AxisEffort alone = caught(false), together = caught(true);
  EXPECT_NEAR(alone[0], 0.3 * 2.0 * 1.8, tolerance(1e-9));
  EXPECT_EQ(alone[2], 0.0);
  EXPECT_EQ(together[0], alone[0]);  // bit for bit
  EXPECT_NEAR(together[2], 0.1 * 2.0 * 1.0, tolerance(1e-9));
  EXPECT_EQ(together[1], 0.0);  // has no reflex
}

TEST(SpasticFist, SlowOpening_TriggersNothing) {
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
