#include "devices/one_axis.hpp"
#include "files/device/device_file.hpp"
#include "files/patient/motion_file.hpp"
#include "files/patient/patient_file.hpp"
#include "loop/device/simulated/simulated_device.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/patient_config.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace wholehand {
namespace {

const std::string kRoot = WHOLEHAND_SOURCE_DIR;

struct FileBench {
  DeviceModel device;
  PatientConfig patient;
  Intention intention;
};

/// A shipped device with the relaxed adult, who follows the first recorded motion.
FileBench shipped(const std::string& device_name) {
  Expected<DeviceModel> device = loadDeviceFile(kRoot + "/config/devices/" + device_name + ".toml");
  EXPECT_TRUE(device.ok()) << (device.ok() ? "" : format(device.errors()));
  Expected<PatientConfig> patient =
      loadPatientFile(kRoot + "/config/patients/relaxed-adult.toml", *device);
  EXPECT_TRUE(patient.ok()) << (patient.ok() ? "" : format(patient.errors()));
  const Expected<MotionFile> motion =
      loadMotionFile(kRoot + "/data/human-motion/reach-grasp-00.csv", &*device);
  EXPECT_TRUE(motion.ok()) << (motion.ok() ? "" : format(motion.errors()));
  Intention intention = Intention::fromMotion(*motion, patient->motion, *device,
                                              AxisPosition(device->axisCount()), nullptr);
  return {*device, *patient, std::move(intention)};
}

class ShippedDevice : public ::testing::TestWithParam<std::pair<const char*, int>> {};
INSTANTIATE_TEST_SUITE_P(Files, ShippedDevice,
                         ::testing::Values(std::pair{"desktop-3axis", 3},
                                           std::pair{"lambda-pride", 6},
                                           std::pair{"wrist-9axis", 9}));

TEST_P(ShippedDevice, RecordedMotion_IsFollowedInsideTheRange) {
  const FileBench s = shipped(GetParam().first);
  ASSERT_EQ(s.device.axisCount(), GetParam().second);
  SimulatedDevice device(s.device, s.patient, s.intention, 1e-3);
  ASSERT_TRUE(device.open().ok());
  const int ticks = static_cast<int>(1000.0 * (s.intention.duration_s() + 2.0));
  DeviceReading reading;
  for (int i = 0; i < ticks; ++i) {
    ASSERT_EQ(device.read(reading, 1), Fault::kNone);
    ASSERT_EQ(reading.q_m.size(), s.device.axisCount());
    ASSERT_TRUE(allFinite(reading.q_m) && allFinite(test::personAt(device).effort));
    for (int k = 0; k < reading.q_m.size(); ++k) {
      const DeviceAxis& axis = s.device.axes[k];
      ASSERT_GE(device.position()[k], axis.lower);
      ASSERT_LE(device.position()[k], axis.upper);
      ASSERT_LE(std::abs(device.velocity()[k]), axis.speed_limit) << axis.name << " at " << i;
    }
  }
  // At rest after the end, the person's error is at most dry friction over stiffness.
  for (int k = 0; k < reading.q_m.size(); ++k) {
    const double slack = s.device.axes[k].coulomb / s.patient.axes[k].stiffness;
    EXPECT_NEAR(reading.q_m[k], test::personAt(device).intention[k],
                1.01 * slack + s.device.axes[k].encoder_step)
        << s.device.axes[k].name;
  }
}

}  // namespace
}  // namespace wholehand
