#include "control/certificate/certificate_refusal.hpp"
#include "dynamics/articulated_body.hpp"
#include "model/hand/hand_file.hpp"
#include "support/figure.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace wholehand::test {
namespace {

struct Shipped {
  const char* name;  ///< of the device and of the gains that go with it
  const char* hand;
};

class ShippedGains : public testing::TestWithParam<Shipped> {
 protected:
  void SetUp() override {
    const std::string root = std::string(WHOLEHAND_SOURCE_DIR) + "/config/";
    device_ = orThrow(loadDeviceFile(root + "devices/" + GetParam().name + ".toml"));
    rendering_ =
        orThrow(loadRenderingFile(root + "rendering/" + GetParam().name + ".toml", device_));
    hand_ =
        orThrow(assembleHand(orThrow(loadHandFile(root + "hands/" + GetParam().hand)), device_));
  }

  AxisMatrix inertiaAt(const AxisPosition& q_s) const {
    ArticulatedBody body(hand_);
    JointPosition theta = hand_.theta0;
    theta.vec() += hand_.synergy * q_s.vec();
    EXPECT_TRUE(body.update(theta, JointVelocity(hand_.joint_count), Eigen::Vector3d::Zero()));
    return body.reducedInertia();
  }

  DeviceModel device_;
  RenderingConfig rendering_;
  HandModel hand_;
};

TEST_P(ShippedGains, AtOneToFourKilohertz_PassTheirOwnCertificate) {
  CertificateInput input;
  input.device = device_;
  input.rendering = rendering_;
  input.inertia_at_reference = inertiaAt(hand_.reference);
  for (int k = 0; k <= 10; ++k) {
    AxisPosition q(device_.axisCount());
    for (int a = 0; a < device_.axisCount(); ++a) {
      const DeviceAxis& axis = device_.axes[a];
      q[a] = axis.lower + 0.1 * ((k * (a + 1)) % 11) * (axis.upper - axis.lower);
    }
    input.inertias.push_back(inertiaAt(q));
  }
  for (const double rate_hz : {1000.0, 2000.0, 4000.0}) {
    input.period_s = 1.0 / rate_hz;
    const Diagnostics refused = refuseUncertified(input);
    EXPECT_TRUE(refused.empty()) << rate_hz << " Hz: " << format(refused);
  }
}

TEST_P(ShippedGains, Translations_CarryNoArmature) {
  const auto gains = resolveGains(rendering_, inertiaAt(hand_.reference), 1e-3);
  ASSERT_TRUE(gains.ok()) << format(gains.errors());
  for (int a = 0; a < device_.axisCount(); ++a) {
    if (device_.axes[a].kind != AxisKind::kTranslation) continue;
    EXPECT_EQ(gains->armature[a], 0.0) << device_.axes[a].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Config, ShippedGains,
                         testing::Values(Shipped{"lambda-pride", "adult-median-right.toml"},
                                         Shipped{"lambda-pride", "woman-p05-right.toml"},
                                         Shipped{"lambda-pride", "man-p95-right.toml"},
                                         Shipped{"desktop-3axis", "adult-median-left.toml"},
                                         Shipped{"wrist-9axis", "adult-median-right.toml"}));

}  // namespace
}  // namespace wholehand::test
