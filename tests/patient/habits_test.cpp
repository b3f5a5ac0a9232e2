// What a person does of their own accord, against closed forms.
#include "patient/habits.hpp"

#include "patient/active_patient.hpp"
#include "patient/person_tools.hpp"
#include "support/constants.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

DeviceModel fingers() {
  return digits({"finger_flexion", "thumb_flexion"});
}

PatientInput felt(double q, double qd, double rendered = 0.0, double impedance = 0.0) {
  return {AxisPosition(2, q), AxisVelocity(2, qd), AxisEffort(2, rendered),
          AxisEffort(2, impedance)};
}

TEST(ActivePatient, WithoutHabits_DoesNothingAndHoldsOn) {
  ActivePatient person(calm(2), fingers(), kPeriod_s);
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
  PatientConfig patient = calm(2);
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
  // Correlation of the axes is the cosine between their phases: not one rhythm for both.
  EXPECT_LT(std::abs(at_quarter / kTicks), 0.95 * 0.5 * 0.08 * 0.05);
}

TEST(Tremor, PhaseSeed_DecidesThePhasesAndNothingElse) {
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
  PatientConfig patient = calm(2);
  patient.axes[0].reflex = {gain, 60.0 * kDeg, 2.0};
  patient.reflex = {0.04, 0.03};
  return patient;
}

/// Opened at a constant speed from t = 0, from where the reflex begins.
double pulledAfter(double seconds, double speed_rad_s, double period_s) {
  ActivePatient person(spastic(), fingers(), period_s);
  for (int k = 0; k < std::lround(seconds / period_s); ++k) {
    person.advance(felt(2.0 - speed_rad_s * k * period_s, -speed_rad_s));
  }
  return person.end()[0];
}

TEST(SpasticCatch, OpenedAtConstantSpeed_IsTheClosedFormAfterTheDelay) {
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

TEST(SpasticCatch, SlowOpeningClosingOrBeyondTheAngle_IsNotCaught) {
  EXPECT_EQ(pulledAfter(0.3, 59.0 * kDeg, kPeriod_s), 0.0);
  EXPECT_GT(pulledAfter(0.3, 70.0 * kDeg, kPeriod_s), 0.0);
  EXPECT_EQ(reflexDrive({0.3, 1.0, 2.0}, 1.0, 3.0), 0.0);   // closing
  EXPECT_EQ(reflexDrive({0.3, 1.0, 2.0}, 2.1, -3.0), 0.0);  // more flexed than the threshold
  EXPECT_EQ(reflexDrive({0.3, 1.0, 2.0}, 1.5, -3.0), 0.3 * 2.0 * 0.5);
}

TEST(SpasticCatch, OpeningThatStops_StillPullsForTheDelayAndFadesWithTheMuscle) {
  ActivePatient person(spastic(), fingers(), kPeriod_s);
  for (int k = 0; k < 200; ++k) person.advance(felt(2.0 - 3.0 * k * kPeriod_s, -3.0));
  const double caught = person.end()[0];
  for (int k = 0; k < 40; ++k) person.advance(felt(1.4, 0.0));
  const double late = person.end()[0];
  EXPECT_GT(late, 0.9 * caught);  // the device stands, the person still pulls: active
  for (int k = 0; k < 30; ++k) person.advance(felt(1.4, 0.0));
  EXPECT_NEAR(person.end()[0], late * std::exp(-1.0), 1e-12);  // one lag later
  EXPECT_EQ(person.end()[1], 0.0);                             // the thumb has no reflex here
}

// ---- fight

TEST(Fight, WhateverIsFelt_IsAnsweredWithAllOfIt) {
  EXPECT_EQ(fightEffort(0.4, 0.1, -3.0, 0.1), -0.4);  // on with the motion
  EXPECT_EQ(fightEffort(0.4, 0.1, 3.0, 0.1), 0.4);
  EXPECT_EQ(fightEffort(0.4, 0.1, 0.09, 0.1), -0.4);  // at rest: against the device
  EXPECT_EQ(fightEffort(0.4, -0.1, -0.09, 0.1), 0.4);
  EXPECT_EQ(fightEffort(0.4, 0.0, 0.0, 0.1), 0.4);
}

TEST(Fight, ReactionTime_IsThatOfWhatWasFelt) {
  PatientConfig patient = calm(2);
  patient.axes[0].fight = 0.4;
  patient.fight_reaction_s = 0.02;
  ActivePatient person(patient, fingers(), kPeriod_s);
  int turned_at = -1;
  for (int k = 0; k < 50; ++k) {
    person.advance(felt(1.0, 0.0, k < 10 ? -1.0 : 1.0));
    ASSERT_EQ(person.begin()[0], person.end()[0]);  // held over the period
    ASSERT_EQ(std::abs(person.end()[0]), 0.4);
    if (turned_at < 0 && person.end()[0] < 0.0) turned_at = k;
  }
  EXPECT_EQ(turned_at, 10 + 20);
}

TEST(ActivePatient, AllHabitsTogether_AreHeldToTheDevicesLimit) {
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

TEST(LettingGo, AtItsTime_NothingOfThePersonIsLeft) {
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

TEST(LettingGo, AtItsEffort_IsForGood) {
  PatientConfig patient = calm(2);
  patient.letting_go.effort_share = 0.5;  // 1 N·m
  ActivePatient person(patient, fingers(), kPeriod_s);
  person.advance(felt(1.0, 0.0, 0.0, 0.99));
  EXPECT_FALSE(person.hasLetGo());
  person.advance(felt(1.0, 0.0, 0.0, -1.01));
  EXPECT_TRUE(person.hasLetGo());
  person.advance(felt(1.0, 0.0, 0.0, 0.0));
  EXPECT_TRUE(person.hasLetGo());
}

}  // namespace
}  // namespace wholehand::test
