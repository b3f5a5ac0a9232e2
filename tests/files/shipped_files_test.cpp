#include "files/device/device_file.hpp"
#include "files/device/rendering_file.hpp"
#include "files/hand/hand_file.hpp"
#include "files/patient/patient_file.hpp"
#include "files/shipped_models.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/model/device_model.hpp"
#include "loop/model/rendering_config.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

namespace wholehand::test {
namespace {

const std::set<std::string> kDevices = {"lambda-pride", "desktop-3axis", "wrist-9axis"};
const std::set<std::string> kPatients = {
    "relaxed-adult", "stiff-adult",  "no-arm", "tremor",           "spastic",
    "releases",      "slams",        "fights", "enslaved-fingers", "spastic-fist",
    "pill-rolling",  "holds-a-ball", "weak"};
/// Not a constant: kHandSizes of another source may be initialised later.
std::set<std::string> handNames() {
  std::set<std::string> both;
  for (const std::string& size : kHandSizes) both.insert({size + "-left", size + "-right"});
  return both;
}

std::set<std::string> stems(const std::string& folder) {
  std::set<std::string> out;
  for (const auto& entry : std::filesystem::directory_iterator(kConfig + folder)) {
    out.insert(entry.path().stem().string());
  }
  return out;
}

template <class T>
T orFail(Expected<T> loaded) {
  if (!loaded) {
    ADD_FAILURE() << format(loaded.errors());
    return {};
  }
  return std::move(loaded).value();
}

TEST(ShippedFiles, EveryFolder_HasEveryDocumentedFile) {
  EXPECT_EQ(stems("devices"), kDevices);
  EXPECT_EQ(stems("rendering"), kDevices);  // gains for every device
  EXPECT_EQ(stems("patients"), kPatients);
  EXPECT_EQ(stems("hands"), handNames());
}

TEST(ShippedFiles, EveryDevice_FitsItsGainsAndEveryPatientAndHand) {
  for (const std::string& name : kDevices) {
    SCOPED_TRACE(name);
    const auto device = orFail(loadDeviceFile(kConfig + "devices/" + name + ".toml"));
    EXPECT_EQ(device.name, name);
    const auto rendering =
        orFail(loadRenderingFile(kConfig + "rendering/" + name + ".toml", device));
    ASSERT_EQ(rendering.axes.size(), device.axes.size());
    for (const std::string& patient_name : kPatients) {
      const auto patient =
          orFail(loadPatientFile(kConfig + "patients/" + patient_name + ".toml", device));
      ASSERT_EQ(patient.axes.size(), device.axes.size());
      for (std::size_t i = 0; i < patient.axes.size(); ++i) {
        EXPECT_EQ(patient.axes[i].name, device.axes[i].name);
        // The patient without an arm has no stiffness; all others pull on every axis of every
        // shipped device.
        EXPECT_EQ(patient.axes[i].stiffness > 0.0, patient_name != "no-arm");
      }
    }
    for (const std::string& hand_name : handNames()) {
      SCOPED_TRACE(hand_name);
      const auto hand_file = orFail(loadHandFile(kConfig + "hands/" + hand_name + ".toml"));
      const auto hand = orFail(assembleHand(hand_file, device));
      EXPECT_EQ(hand.axis_count, device.axisCount());
      EXPECT_EQ(hand.capsules.size(), 41U);
    }
  }
}

// The defaults that the documentation and the certificate cite (docs/equations.md).
TEST(ShippedFiles, LambdaPride_HasTheDocumentedDefaults) {
  const auto device = orFail(loadDeviceFile(kConfig + "devices/lambda-pride.toml"));
  ASSERT_EQ(device.axisCount(), 6);
  const auto& x = device.axes[0];
  EXPECT_EQ(x.name, "x");
  EXPECT_EQ(x.kind, AxisKind::kTranslation);
  EXPECT_EQ(x.group, AxisGroup::kBase);
  EXPECT_EQ(x.upper, 0.085);
  EXPECT_EQ(x.effort_limit, 20.0);
  EXPECT_EQ(x.mass, 0.8);
  EXPECT_EQ(x.encoder_step, 1e-5);
  EXPECT_EQ(device.output_delay_ticks, 1);
  const auto& fingers = device.axes[device.axisIndex("finger_flexion")];
  EXPECT_EQ(fingers.group, AxisGroup::kHand);
  EXPECT_NEAR(fingers.upper, 3.14159265358979, 1e-12);    // 180 degrees
  EXPECT_NEAR(fingers.effort_limit, 10.0 * 0.08, 1e-15);  // 10 N at the tip, lever arm 0.08 m
  EXPECT_EQ(device.neutral()[0], 0.0);

  const auto gains = orFail(loadRenderingFile(kConfig + "rendering/lambda-pride.toml", device));
  EXPECT_EQ(gains.axes[0].k_pm, 1000.0);
  EXPECT_EQ(gains.axes[0].effort_dead, 0.5);
  EXPECT_FALSE(gains.axes[0].armature.has_value());  // set by the rule
  EXPECT_EQ(gains.axes[3].k_pm, 4.0);
  EXPECT_NEAR(gains.axes[3].effort_full, 5.0 * 0.08, 1e-15);
  EXPECT_EQ(gains.axes[4].effort_full, 0.3);
  EXPECT_EQ(gains.axes[5].gamma, 0.3);
  EXPECT_EQ(gains.axes[5].velocity_filter_hz, 30.0);
}

TEST(ShippedFiles, Kind_IsReadFromTheFileItself) {
  EXPECT_EQ(orFail(fileKind(kConfig + "devices/lambda-pride.toml")), "device");
  EXPECT_EQ(orFail(fileKind(kConfig + "hands/adult-median-right.toml")), "hand");
  EXPECT_EQ(orFail(fileKind(kConfig + "rendering/lambda-pride.toml")), "rendering");
  EXPECT_EQ(orFail(fileKind(kConfig + "patients/no-arm.toml")), "patient");
}

}  // namespace
}  // namespace wholehand::test
