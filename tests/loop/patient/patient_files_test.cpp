// The shipped patients, and the messages for wrong files.
#include "files/patient/patient_file.hpp"
#include "files/shipped_models.hpp"
#include "loop/model/patient_config.hpp"
#include "support/contains.hpp"
#include "support/file_bytes.hpp"
#include "support/folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iterator>

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

struct PatientMistake {
  std::string patient, find, replace;  ///< the shipped file with this text replaced by that
  std::string key, expected;
};

class WrongPatientFile : public testing::TestWithParam<PatientMistake> {};

TEST_P(WrongPatientFile, OneMistake_IsOneMessageWithItsKey) {
  const PatientMistake& c = GetParam();
  const std::string text = replaced(bytesOfFile(patientPath(c.patient)), c.find, c.replace);
  const Folder folder;
  const auto loaded = loadPatientFile(folder.write("p.toml", text), deviceNamed("lambda-pride"));
  ASSERT_FALSE(loaded.ok());
  ASSERT_EQ(loaded.errors().size(), 1U) << format(loaded.errors());
  const Diagnostic& fault = loaded.errors().front();
  EXPECT_EQ(fault.key, c.key) << format(fault);
  EXPECT_TRUE(contains((fault.problem + "; " + fault.remedy), c.expected)) << format(fault);
  EXPECT_GT(fault.line, 0);
}
INSTANTIATE_TEST_SUITE_P(
    Mistakes, WrongPatientFile,
    testing::ValuesIn(std::vector<PatientMistake>{
        {"tremor", "frequency_hz = 5.0", "frequency_hz = 2.9", "tremor.frequency_hz", "[3, 12] Hz"},
        {"tremor", "frequency_hz = 5.0", "frequency_hz = 5.0\nfrequency = 6.0", "tremor.frequency",
         "frequency_hz"},
        {"tremor", "tremor_n = 2.0", "tremor_n = 11.0", "axes[x].tremor_n", "[0, 10] N"},
        {"tremor", "tremor_n = 2.0", "tremor_nm = 2.0", "axes[x].tremor_nm", "tremor_n"},
        {"tremor", "tremor_n = 2.0", "tremor_tip_n = 2.0", "axes[x].tremor_tip_n", "fingertip"},
        {"weak", "strength_tip_n = 0.5", "strength_tip_n = 0",
         "axes[finger_flexion].strength_tip_n", "(0, 10000] N"},
        {"weak", "strength_tip_n = 0.5", "strength_n = 0.5", "axes[finger_flexion].strength_n",
         "strength_nm"},
        {"spastic", "delay_s = 0.04", "delay_s = 0.3", "reflex.delay_s", "[0, 0.2] s"},
        {"spastic", "muscle_lag_s = 0.03", "muscle_lag_s = 0", "reflex.muscle_lag_s", "(0, 0.5] s"},
        {"spastic", "reflex_below_rad = 2.0\n", "", "axes[finger_flexion].reflex_below_rad",
         "missing"},
        {"spastic", "stiffness_n_m = 300.0", "stiffness_n_m = 300.0\nreflex_gain_nm_s_rad2 = 1",
         "axes[x].reflex_gain_nm_s_rad2", "rotations"},
        {"releases", "after_s = 4.0 ", "#after_s = -1\nafter_s = -1 ", "letting_go.after_s",
         "[0, 3600] s"},
        {"releases", "effort_share = 0.6", "effort_share = 0", "letting_go.effort_share",
         "(0, 10]"},
        {"slams", "axis = \"x\"", "axis = \"w\"", "slam.axis", "neither an axis of the device"},
        {"slams", "towards = \"upper\"", "towards = \"up\"", "slam.towards", "upper"},
        {"slams", "speed_share = 0.98", "speed_share = 2.5", "slam.speed_share", "(0, 2]"},
        {"slams", "effort_share = 2.0", "effort_share = 6", "slam.effort_share", "(0, 5]"},
        {"fights", "reaction_s = 0.0", "reaction_s = 1.5", "fight.reaction_s", "[0, 1] s"},
        {"relaxed-adult", "[motion]", "[fight]\nreaction_s = 0.1\n[motion]", "fight",
         "has no effect"},
        {"relaxed-adult", "stiffness_n_m = 300.0", "stiffness_n_m = 300.0\nfight_n = 3.0", "fight",
         "is missing"},
        {"relaxed-adult", "[motion]", "[letting_go]\n[motion]", "letting_go",
         "neither after_s nor effort_share"}}));

}  // namespace
}  // namespace wholehand::test
