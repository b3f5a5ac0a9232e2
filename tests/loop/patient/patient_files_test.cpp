// The shipped patients, and the messages for wrong files.
#include "files/shipped_models.hpp"
#include "loop/model/patient_config.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

TEST(ShippedPatients, PassivePatients_HaveNoHabits) {
  for (const char* name : {"relaxed-adult", "stiff-adult", "no-arm"}) {
    const PatientConfig patient = patientNamed(name);
    for (const PatientAxis& axis : patient.axes) {
      EXPECT_EQ(axis.tremor + axis.fight + axis.reflex.gain_nm_s_rad2, 0.0) << name;
    }
    EXPECT_TRUE(patient.slam.axis.empty());
    EXPECT_FALSE(std::isfinite(patient.letting_go.after_s));
    EXPECT_FALSE(std::isfinite(patient.letting_go.effort_share));
  }
}

// Ranges from the literature that docs/patients.md cites.
TEST(ShippedPatients, ActivePatients_AreWithinPublishedRanges) {
  const DeviceModel model = deviceNamed("lambda-pride");
  const PatientConfig tremor = patientNamed("tremor"), spastic = patientNamed("spastic");
  EXPECT_GE(tremor.tremor.frequency_hz, 3.0);
  EXPECT_LE(tremor.tremor.frequency_hz, 12.0);
  for (std::size_t i = 0; i < model.axes.size(); ++i) {
    const DeviceAxis& axis = model.axes[i];
    const double tip_n = tremor.axes[i].tremor / (axis.lever_arm_m > 0.0 ? axis.lever_arm_m : 1.0);
    EXPECT_GE(tip_n, 0.5) << axis.name;
    EXPECT_LE(tip_n, 3.0) << axis.name;
    EXPECT_LT(tremor.axes[i].tremor, axis.effort_limit) << axis.name;
    const StretchReflex& reflex = spastic.axes[i].reflex;
    EXPECT_EQ(reflex.gain_nm_s_rad2 > 0.0, axis.group == AxisGroup::kHand) << axis.name;
    if (reflex.gain_nm_s_rad2 == 0.0) continue;
    EXPECT_GE(reflex.from_speed_rad_s, 30.0 * kDeg) << axis.name;
    EXPECT_LE(reflex.from_speed_rad_s, 100.0 * kDeg) << axis.name;
  }
  EXPECT_EQ(spastic.reflex.delay_s, 0.04);
  EXPECT_EQ(spastic.reflex.muscle_lag_s, 0.03);
}

TEST(ShippedPatients, OnADeviceWithoutFingers_KeepTheHabitsOfTheArm) {
  const PatientConfig fights = patientNamed("fights", "desktop-3axis");
  ASSERT_EQ(fights.axes.size(), 3U);
  EXPECT_EQ(fights.axes[2].fight, 12.0);
  EXPECT_EQ(patientNamed("spastic", "desktop-3axis").axes[0].reflex.gain_nm_s_rad2, 0.0);
  EXPECT_EQ(patientNamed("slams", "desktop-3axis").slam.axis, "x");
}

}  // namespace
}  // namespace wholehand::test
