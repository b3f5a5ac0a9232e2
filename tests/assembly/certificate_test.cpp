// Every shipped rendering on its device with every shipped hand, as shipped.
#include "assembly/sampled_inertia.hpp"
#include "support/rig_tools.hpp"

#include <filesystem>

namespace wholehand::test {
namespace {

std::vector<std::string> shipped(const std::string& kind) {
  std::vector<std::string> names;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(WHOLEHAND_SOURCE_DIR) + "/config/" + kind)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::sort(names.begin(), names.end());
  return names;
}

class ShippedCertificate : public testing::TestWithParam<std::string> {};

TEST_P(ShippedCertificate, WithEveryHand_IsCertifiedAsShipped) {
  const std::vector<std::string> hands = shipped("hands");
  ASSERT_GE(hands.size(), 8U);
  ASSERT_EQ(shipped("devices"), shipped("rendering"));  // each device with its own gains
  double least = 100.0;
  for (const std::string& hand : hands) {
    const Models m = load(shippedFiles(GetParam(), "empty", hand));
    const Certificate c = certify(certificateInput(m, 1e-3));
    EXPECT_TRUE(c.certified) << hand << ": " << c.binding();
    ASSERT_EQ(static_cast<int>(c.axes.size()), m.device.axisCount());
    for (const AxisCertificate& a : c.axes) EXPECT_TRUE(a.passes) << hand << " " << a.of.axis.name;
    least = std::min(least, c.margin());
  }
  EXPECT_GE(least, 1.0);
  figure("least margin of " + GetParam(), least, "");
}
INSTANTIATE_TEST_SUITE_P(Devices, ShippedCertificate, testing::ValuesIn(shipped("rendering")),
                         [](const auto& tested) {
                           std::string name = tested.param;
                           std::erase_if(name, [](char c) { return c == '-'; });
                           return name;
                         });

/// The certificate and the check before a run must speak of the same gains.
TEST(Certificate, Loops_AreThoseOfTheGainsThatRun) {
  for (const std::string& device : shipped("devices")) {
    const Models m = load(shippedFiles(device));
    const CheckedGains checked = orThrow(checkGains(m, 1e-3));
    const CertificateInput input = certificateInput(m, 1e-3);
    for (int a = 0; a < checked.gains.axes; ++a) {
      const AxisLoop judged = axisCase(input, a).loop(1.0);
      const AxisLoop run = axisLoop(m.device, checked.gains, a, 1e-3);
      EXPECT_EQ(judged.mass, run.mass);
      EXPECT_EQ(judged.damping, run.damping);
      EXPECT_EQ(judged.delay_ticks, run.delay_ticks);
      EXPECT_EQ(judged.k_pm, run.k_pm);
      EXPECT_EQ(judged.phi_k_dm, run.phi_k_dm);
      EXPECT_EQ(judged.gamma, run.gamma);
      EXPECT_EQ(judged.k_ps_per_s2, run.k_ps_per_s2);
      EXPECT_EQ(judged.k_ds_per_s, run.k_ds_per_s);
      EXPECT_EQ(judged.filter_tau_s, run.filter_tau_s);
    }
  }
}

}  // namespace
}  // namespace wholehand::test
