// A glove with an axis for every finger joint: twelve rotations, no base. 3^12 postures would take
// minutes; the gate must stay quick and still see the corners.
#include "assembly/sampled_inertia.hpp"
#include "model/hand/hand_file.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wholehand::test {
namespace {

const std::string kRoot = WHOLEHAND_SOURCE_DIR;

Models glove() {
  auto file = loadHandFile(kRoot + "/config/hands/adult-median-right.toml");
  EXPECT_TRUE(file.ok());
  file->synergy.clear();
  file->reference.clear();
  Models models;
  for (const JointRange& joint : file->joints) {
    if (joint.joint.find("thumb") != std::string::npos) continue;
    file->synergy.push_back({joint.joint, joint.joint, 1.0});
    file->reference.emplace_back(joint.joint, 0.5 * joint.upper_rad);
    DeviceAxis axis;
    axis.name = joint.joint;
    axis.kind = AxisKind::kRotation;
    axis.group = AxisGroup::kHand;
    axis.lower = joint.lower_rad;
    axis.upper = joint.upper_rad;
    axis.effort_limit = 1.0;
    axis.speed_limit = 10.0;
    axis.mass = 1e-4;
    models.device.axes.push_back(axis);
  }
  auto hand = assembleHand(*file, models.device);
  EXPECT_TRUE(hand.ok()) << (hand.ok() ? "" : format(hand.errors()));
  models.hand = std::move(*hand);
  return models;
}

TEST(SampledInertia, GloveOfTwelveRotations_IsSampledAndNotEnumerated) {
  const Models models = glove();
  ASSERT_EQ(models.device.axisCount(), 12);
  const SampledInertia inertia = sampleInertia(models.hand, models.device);
  EXPECT_EQ(inertia.samples.size(), 729U);  // 3^6, as many as six rotations have
  const SampledInertia again = sampleInertia(models.hand, models.device);
  for (std::size_t i = 0; i < inertia.samples.size(); ++i) {
    ASSERT_EQ(inertia.samples[i], again.samples[i]);  // the same verdict every time
    EXPECT_GT(inertia.samples[i].diagonal().minCoeff(), 0.0);
  }
  // A straight finger is harder to turn at its knuckle than a bent one: both ends are among them.
  EXPECT_GT(inertia.samples[0](0, 0), inertia.samples[2](0, 0));
}

}  // namespace
}  // namespace wholehand::test
