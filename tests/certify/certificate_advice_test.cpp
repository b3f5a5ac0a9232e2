#include "certify/certificate_refusal.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace wholehand::test {
namespace {

/// Equal axes, each with its own inertia of 0.25 kg.
CertificateInput inputOf(int axes, double damping, double k_pm, double k_dm, double gamma,
                         double k_ps = 0.0) {
  CertificateInput in;
  in.device.output_delay_ticks = 1;
  for (int i = 0; i < axes; ++i) {
    DeviceAxis axis;
    axis.name = std::string(1, static_cast<char>('x' + i));
    axis.mass = 0.8;
    axis.damping = damping;
    in.device.axes.push_back(axis);
    AxisRendering gains;
    gains.name = axis.name;
    gains.k_pm = k_pm;
    gains.k_dm = k_dm;
    gains.gamma = gamma;
    if (k_ps > 0.0) gains.armature = 0.0;
    in.rendering.axes.push_back(gains);
  }
  const double inertia = k_ps > 0.0 ? k_pm / k_ps : 0.25;
  in.inertia_at_reference = inertia * AxisMatrix::Identity(axes, axes);
  in.inertias = {in.inertia_at_reference};
  return in;
}

TEST(NearestGains, TooStiff_LowersTheStiffnessToTheLimit) {
  const CertificateInput in = inputOf(1, 6.0, 50000.0, 10.0, 0.3);
  const Certificate judged = certify(in);
  EXPECT_FALSE(judged.certified);
  EXPECT_EQ(judged.binding(), "x.damping");
  const auto nearest = nearestGains(in, judged);
  ASSERT_TRUE(nearest.has_value());
  EXPECT_EQ((*nearest)[0].k_dm, 10.0);
  EXPECT_FALSE((*nearest)[0].armature.has_value());
  EXPECT_TRUE(certify(withGains(in, *nearest)).certified);
  auto stiffer = *nearest;
  stiffer[0].k_pm *= 1.03;
  EXPECT_FALSE(certify(withGains(in, stiffer)).certified);
}

TEST(NearestGains, SuggestedGains_PassForManyFailures) {
  int failures = 0;
  std::size_t index = 0;
  for (const double damping : {0.5, 12.0}) {
    for (const double k_pm : {800.0, 1e5}) {
      for (const double k_dm : {0.0, 30.0, 500.0}) {
        for (const double gamma : {0.0, 0.3}) {
          if (leftOutUnderASanitizer(index++)) continue;
          const CertificateInput in = inputOf(1, damping, k_pm, k_dm, gamma);
          const Certificate judged = certify(in);
          if (judged.certified) continue;
          ++failures;
          EXPECT_LT(judged.margin(), 1.0);
          const auto nearest = nearestGains(in, judged);
          ASSERT_TRUE(nearest.has_value()) << damping << " " << k_pm << " " << k_dm << " " << gamma;
          EXPECT_TRUE(certify(withGains(in, *nearest)).certified)
              << damping << " " << k_pm << " " << k_dm << " " << gamma;
          EXPECT_LE((*nearest)[0].k_pm, k_pm);
          EXPECT_LE((*nearest)[0].k_dm, k_dm);
        }
      }
    }
  }
  if (kStatisticsMeaningful) EXPECT_GT(failures, 15);
}

TEST(NearestGains, AxesThatExciteEachOther_AreSlowedTogether) {
  CertificateInput in = inputOf(2, 12.0, 500.0, 5.0, 0.3, 4e4);
  AxisMatrix coupled = in.inertia_at_reference;
  coupled(0, 1) = coupled(1, 0) =
      0.95 * coupled(0, 0);  // λmax of M⁻¹ diag(M) = 1 / (1 − 0.95) = 20
  in.inertias.push_back(coupled);
  const Certificate judged = certify(in);
  EXPECT_FALSE(judged.certified);
  EXPECT_EQ(judged.binding(), "avatar");
  EXPECT_EQ(judged.avatar.posture, 1U);
  // w (4 − w) = 4/20 gives w = 0.05064, k_p = 2565: a factor of 0.0641 of 4e4.
  EXPECT_NEAR(judged.avatar.margin, 0.0641, 0.0003);
  const auto nearest = nearestGains(in, judged);
  ASSERT_TRUE(nearest.has_value());
  EXPECT_GT((*nearest)[0].armature.value_or(0.0), 0.0);
  EXPECT_TRUE(certify(withGains(in, *nearest)).certified);
}

TEST(NearestGains, AvatarThatRingsInASlowLoop_IsSlowedDown) {
  CertificateInput in = inputOf(1, 12.0, 100.0, 0.0, 0.3, 4.5e4);
  in.period_s = 1.0 / 200.0;  // 1/T² = 4e4
  const Certificate judged = certify(in);
  EXPECT_FALSE(judged.certified);
  const auto nearest = nearestGains(in, judged);
  ASSERT_TRUE(nearest.has_value());
  // K_pm / (M + A) at most 1/T²: M = 100 / 4.5e4.
  EXPECT_GE((*nearest)[0].armature.value_or(0.0), (*nearest)[0].k_pm / 4e4 - 100.0 / 4.5e4);
  EXPECT_TRUE(certify(withGains(in, *nearest)).certified);
}

TEST(NearestGains, DeviceWithoutDamping_HasNoSuggestion) {
  const CertificateInput in = inputOf(1, 0.0, 100.0, 1.0, 0.0);
  const Certificate judged = certify(in);
  EXPECT_FALSE(judged.certified);
  EXPECT_FALSE(nearestGains(in, judged).has_value());
}

TEST(Advice, AdmittedStiffness_PassesAtItsRateAndSlightlyMoreFails) {
  const CertificateInput in = inputOf(1, 6.0, 1000.0, 10.0, 0.3);
  const AxisCase c = axisCase(in, 0);
  const AxisAdvice advice = advise(c);
  for (std::size_t i = 0; i < kAdmittedRatesHz.size(); ++i) {
    AxisCase at = c;
    at.period_s = 1.0 / kAdmittedRatesHz[i];
    at.gains.k_pm = advice.admitted_k_pm[i];
    EXPECT_TRUE(certifyAxis(at).passes) << kAdmittedRatesHz[i];
    at.gains.k_pm *= 1.03;
    EXPECT_FALSE(certifyAxis(at).passes) << kAdmittedRatesHz[i];
    if (i > 0) {
      EXPECT_GT(advice.admitted_k_pm[i], advice.admitted_k_pm[i - 1]);
    }
  }
  // Without delay and filter, b >= (1 − γ)² K k_d / 4 k_p with k_d = 2 √k_p and k_p = 4 K.
  const double continuous = std::pow(6.0 * 4.0 / (0.7 * 0.7), 2);
  EXPECT_LT(advice.admitted_k_pm[3], continuous);
  EXPECT_GT(advice.admitted_k_pm[3], 0.9 * continuous);
}

TEST(Advice, BestGamma_MatchesTheReferenceTable) {
  // K_pm 1000, k_p 2500, n 1, 30 Hz: the smallest damping, 4.07 N·s/m, is at γ = 0.40. A device of
  // 4.07 N·s/m with an avatar of 1000/2500 kg admits at most 1000 N/m.
  const AxisAdvice advice = advise(axisCase(inputOf(1, 4.07, 1000.0, 0.0, 0.0, 2500.0), 0));
  EXPECT_NEAR(advice.best_gamma, 0.40, 0.051);
  EXPECT_NEAR(advice.best_gamma_k_pm, 1000.0, 15.0);
}

}  // namespace
}  // namespace wholehand::test
