#include "certify/certificate_refusal.hpp"

#include "certified_sets.hpp"
#include "certify/certificate.hpp"
#include "certify/passivity.hpp"
#include "support/contains.hpp"

#include <gtest/gtest.h>

#include <string>

namespace wholehand::test {
namespace {

/// Two axes like the shipped translations, the second named y.
CertificateInput shippedLike() {
  CertificateInput in;
  in.device.name = "device";
  in.device.output_delay_ticks = 1;
  for (const char* name : {"x", "y"}) {
    DeviceAxis axis;
    axis.name = name;
    axis.mass = 0.8;
    axis.damping = 6.0;
    axis.coulomb = 0.2;
    axis.encoder_step = 1e-5;
    axis.speed_limit = 1.5;
    axis.effort_slew_limit = 5000.0;
    in.device.axes.push_back(axis);
    AxisRendering gains;
    gains.name = name;
    gains.k_pm = 1000.0;
    gains.k_dm = 10.0;
    in.rendering.axes.push_back(gains);
  }
  in.rendering.path = "gains.toml";
  in.rendering.name = "gains";
  in.hand = "hand";
  in.inertia_at_reference = 0.25 * AxisMatrix::Identity(2, 2);
  in.inertias = {in.inertia_at_reference};
  return in;
}

double numberAfter(const std::string& text, const std::string& words) {
  const std::size_t at = text.find(words);
  return at == std::string::npos ? std::nan("") : std::atof(text.c_str() + at + words.size());
}

// ---- the exercise's wall

TEST(CertificateWall, RequiredDamping_IsLargestAtACornerOfAlphaAndPhi) {
  // Convex in α and Φ: no share of the wall needs more damping than both no wall and the full wall.
  const CertificateInput in = shippedLike();
  const AxisCase c = axisCase(in, 0);
  const WallCase wall{600.0, 4.0};
  const double corner = std::max(largestRequiredDamping(c, wall, 0.0).damping,
                                 largestRequiredDamping(c, wall, 1.0).damping);
  for (int i = 0; i <= 10; ++i) {
    EXPECT_LE(largestRequiredDamping(c, wall, 0.1 * i).damping, corner * (1.0 + 1e-12));
  }
}

TEST(CertificateWall, StiffnessOfAWall_NeedsDampingForItsDelay) {
  // The wall adds k T (½ + n) to −Re A₀ at frequency zero and nothing to q. Where b_min lies at
  // frequency zero (γ = 0), it grows by exactly that.
  CertificateInput in = shippedLike();
  in.rendering.axes[0].gamma = 0.0;
  in.rendering.axes[0].k_dm = 0.0;
  const AxisCase c = axisCase(in, 0);
  const double more = largestRequiredDamping(c, {500.0, 0.0}, 1.0).damping -
                      largestRequiredDamping(c, {}, 0.0).damping;
  EXPECT_NEAR(more, 500.0 * 1e-3 * 1.5, 2e-3);
}

TEST(CertificateWall, WallThatIsTooStiff_IsTheBindingCriterionAndItsAdmittedSharePasses) {
  CertificateInput in = shippedLike();
  in.device.axes[1].effort_slew_limit = 1e6;
  in.walls = {{1, {500.0, 2.0}}};
  EXPECT_TRUE(certify(in).certified);
  in.walls[0].wall = {2500.0, 2.0};
  const Certificate judged = certify(in);
  EXPECT_FALSE(judged.certified);
  EXPECT_EQ(judged.binding(), "y.wall");
  EXPECT_TRUE(judged.axes[0].passes);  // the wall belongs to y
  const AxisCertificate& y = judged.axes[1];
  EXPECT_EQ(y.wall.wall.stiffness, 2500.0);
  EXPECT_GT(y.wall.damping_required, y.damping_required);
  EXPECT_LT(y.margin, 1.0);
  EXPECT_EQ(y.margin, y.wall.margin);

  const Diagnostics refused = refuseUncertified(in);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].key, "y.k_pm_n_m");
  EXPECT_TRUE(
      contains(refused[0].problem, "not certified (wall): in the exercise's wall of 2500 N/m"));
  const double share = numberAfter(refused[0].remedy, ", or at most ");
  ASSERT_GT(share, 0.1) << refused[0].remedy;
  in.walls[0].wall = {share * 2500.0, share * 2.0};
  EXPECT_TRUE(certify(in).certified);
  in.walls[0].wall = {(share + 0.02) * 2500.0, (share + 0.02) * 2.0};
  EXPECT_FALSE(certify(in).certified);
  in.walls[0].wall = {2500.0, 2.0};
  const double k_pm = numberAfter(refused[0].remedy, "largest allowed k_pm_n_m: ");
  const double k_dm = numberAfter(refused[0].remedy, "with k_dm_n_s_m = ");
  in.rendering.axes[1].k_pm = k_pm;
  if (k_dm > 0.0) in.rendering.axes[1].k_dm = k_dm;
  EXPECT_TRUE(certify(in).certified) << refused[0].remedy;
}

TEST(CertificateWall, UnstableWall_IsReportedWithItsRadius) {
  CertificateInput in = shippedLike();
  in.device.axes[0].effort_slew_limit = 1e6;
  in.walls = {{0, {40000.0, 0.0}}};
  const Certificate judged = certify(in);
  EXPECT_FALSE(judged.axes[0].wall.worst.stable());
  EXPECT_LT(judged.axes[0].wall.margin, 0.5);
  EXPECT_TRUE(contains(finding(judged.axes[0]), "unstable at α = "));
}

TEST(CertificateWall, EncoderSteps_LimitBothSpringsTogether) {
  CertificateInput in = shippedLike();
  in.device.axes[0].encoder_step = 2.5e-4;  // 2 f_c / Δ = 1600 N/m
  in.walls = {{0, {590.0, 0.0}}};
  EXPECT_TRUE(certify(in).certified);
  in.walls[0].wall.stiffness = 610.0;
  const Certificate judged = certify(in);
  EXPECT_FALSE(judged.certified);
  EXPECT_EQ(judged.binding(), "x.wall");
  EXPECT_NEAR(judged.axes[0].wall.margin, 1600.0 / 1610.0, 1e-12);
  EXPECT_TRUE(contains(finding(judged.axes[0]), "quantisation allows 1600 N/m in all, it is 1610"));
}

// ---- slew

TEST(CertificateSlew, RequiredSlew_MatchesItsFormula) {
  CertificateInput in = shippedLike();
  in.walls = {{0, {200.0, 3.0}}};
  const AxisCase c = axisCase(in, 0);
  // K_ps by the rule is 4000 1/s²; K_ds by Eq. (14) is 2 √4000 − 4.
  const double b = 1000.0 * (2.0 * std::sqrt(4000.0) - 4.0) / 4000.0;
  const double d = 0.3 * b + 10.0 + 3.0;
  EXPECT_NEAR(requiredSlew(c), 1.5 * (1200.0 + d * (std::sqrt(1200.0 / 0.8) + (d + 6.0) / 0.8)),
              1e-9);
}

TEST(CertificateSlew, DeviceThatIsTooSlow_IsNotCertifiedAndTheNearestGainsFitIt) {
  CertificateInput in = shippedLike();
  in.device.axes[0].effort_slew_limit = 2000.0;
  const Certificate judged = certify(in);
  EXPECT_FALSE(judged.certified);
  EXPECT_EQ(judged.binding(), "x.slew");
  EXPECT_NEAR(judged.axes[0].margin, 2000.0 / judged.axes[0].slew_required, 1e-12);
  const auto nearest = nearestGains(in, judged);
  ASSERT_TRUE(nearest.has_value());
  EXPECT_LT((*nearest)[0].k_pm, 1000.0);
  EXPECT_EQ((*nearest)[1].k_pm, 1000.0);
  const Diagnostics refused = refuseUncertified(in);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_TRUE(contains(refused[0].problem, "not certified (slew): "));
  in.rendering.axes[0].k_pm = (*nearest)[0].k_pm;
  in.rendering.axes[0].k_dm = (*nearest)[0].k_dm;
  EXPECT_TRUE(certify(in).certified);
  in.device.axes[0].effort_slew_limit = 0.0;  // not stated: not checked
  in.rendering.axes[0].k_pm = 1000.0;
  EXPECT_TRUE(certify(in).certified);
}

// ---- the check before a run

TEST(RefuseUncertified, RandomSets_AreRefusedExactlyWhereCertifyFails) {
  Draw draw(81);
  int refused = 0;
  const int sets = cases(20);
  for (int i = 0; i < sets; ++i) {
    CertificateInput in = shippedLike();
    in.rendering.axes[0].k_pm = draw.between(300.0, 3000.0);
    in.rendering.axes[0].k_dm = draw.between(1.0, 30.0);
    in.rendering.axes[0].gamma = draw.unit();
    in.device.axes[0].effort_slew_limit = draw.chance(0.5) ? 1e4 : draw.between(1500.0, 9000.0);
    in.device.output_delay_ticks = draw.upTo(2);
    if (draw.chance(0.5)) in.walls = {{0, {draw.between(50.0, 2000.0), 4.0 * draw.unit()}}};
    const bool certified = certify(in).certified;
    const Diagnostics said = refuseUncertified(in);
    EXPECT_EQ(said.empty(), certified) << format(said);
    refused += certified ? 0 : 1;
  }
  if (kStatisticsMeaningful) {
    EXPECT_GT(refused, sets / 10);
    EXPECT_LT(refused, sets);
  }
}

TEST(RefuseUncertified, AxisThatFails_NamesCriterionAndAStiffnessThatPasses) {
  CertificateInput in = shippedLike();
  EXPECT_TRUE(refuseUncertified(in).empty());
  in.rendering.axes[1].k_pm = 3000.0;  // stable against a stop, but not with every object
  in.device.axes[1].effort_slew_limit = 1e6;
  const Diagnostics refused = refuseUncertified(in);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].file, "gains.toml");
  EXPECT_EQ(refused[0].key, "y.k_pm_n_m");
  EXPECT_EQ(refused[0].value, "3000 N/m");
  EXPECT_EQ(refused[0].problem.rfind("not certified (damping): any passive person and object", 0),
            0U)
      << refused[0].problem;
  in.rendering.axes[1].k_pm = numberAfter(refused[0].remedy, "largest allowed k_pm_n_m: ");
  EXPECT_TRUE(certify(in).certified) << refused[0].remedy;
}

TEST(RefuseUncertified, EveryAxisThatFails_IsReportedInItsOwnUnits) {
  CertificateInput in = shippedLike();
  in.device.axes[0].damping = 0.1;
  in.device.axes[1].kind = AxisKind::kRotation;  // the numbers of a finger axis
  in.device.axes[1].name = "finger_flexion";
  in.device.axes[1].mass = 5e-4;
  in.device.axes[1].damping = 1e-4;
  in.rendering.axes[1].k_pm = 4.0;
  in.rendering.axes[1].k_dm = 0.024;
  in.inertia_at_reference(1, 1) = 1e-4;
  in.inertias = {in.inertia_at_reference};
  const Diagnostics refused = refuseUncertified(in);
  ASSERT_EQ(refused.size(), 2U);
  EXPECT_EQ(refused[0].key, "x.k_pm_n_m");
  EXPECT_EQ(refused[1].key, "finger_flexion.k_pm_nm_rad");
  EXPECT_EQ(refused[1].value, "4 N·m/rad");
  EXPECT_TRUE(
      contains(refused[1].remedy, "(device damping 0.0001 N·m·s/rad, 1 tick of delay, 1000 Hz)"));
}

TEST(RefuseUncertified, TooMuchDamping_AlsoNamesADampingThatPasses) {
  CertificateInput in = shippedLike();
  in.rendering.axes[0].k_dm = 1000.0;  // a pure damper with a tick of delay admits less
  const Diagnostics refused = refuseUncertified(in);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_TRUE(contains(refused[0].problem, "at Φ = 1: spectral radius"));
  in.rendering.axes[0].k_pm = numberAfter(refused[0].remedy, "largest allowed k_pm_n_m: ");
  in.rendering.axes[0].k_dm = numberAfter(refused[0].remedy, "with k_dm_n_s_m = ");
  EXPECT_LT(in.rendering.axes[0].k_dm, 1000.0);
  EXPECT_TRUE(certify(in).certified) << refused[0].remedy;
}

TEST(RefuseUncertified, DeviceWithNegativeDamping_SaysThatNoGainsPass) {
  CertificateInput in = shippedLike();
  in.device.axes[0].damping = -1.0;
  const Diagnostics refused = refuseUncertified(in);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].remedy.rfind("no smaller gains pass: the device needs more damping", 0), 0U)
      << refused[0].remedy;
}

TEST(RefuseUncertified, AxesThatExciteEachOther_NameThePostureAndTheRemedy) {
  CertificateInput in = shippedLike();
  // k_p = 4e4 1/s² with λmax = 1 / (1 − 0.85): 4w − w² = 4/λmax admits 24,369.
  for (AxisRendering& gains : in.rendering.axes) gains.armature = 0.0;
  in.inertia_at_reference *= in.rendering.axes[0].k_pm / 4e4 / in.inertia_at_reference(0, 0);
  in.inertias = {in.inertia_at_reference};
  AxisMatrix coupled = in.inertia_at_reference;
  coupled(0, 1) = coupled(1, 0) = 0.85 * coupled(0, 0);
  in.inertias.push_back(coupled);
  const Diagnostics refused = refuseUncertified(in);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].key, "armature");
  EXPECT_TRUE(contains(refused[0].problem, "posture 2 of 2"));
  EXPECT_TRUE(contains(refused[0].remedy, "add armature"));
  in.inertias.back()(0, 1) = in.inertias.back()(1, 0) = in.inertias.back()(0, 0);
  const Diagnostics singular = refuseUncertified(in);
  ASSERT_EQ(singular.size(), 1U);
  EXPECT_TRUE(contains(singular[0].remedy, "singular"));
}

// ---- what a certificate covers

TEST(Fingerprint, SameNumbersUnderOtherNames_AreEqual) {
  CertificateInput a = shippedLike(), b = shippedLike();
  b.device.name = "the same under another name";
  b.rendering.path = "elsewhere.toml";
  b.device.axes[0].effort_limit = 12.0;  // the certificate does not depend on it
  EXPECT_EQ(differenceOf(fingerprintOf(a), fingerprintOf(b)), "");
  // The last digits of an inertia depend on the compiler.
  b.inertia_at_reference(0, 0) *= 1.0 + 1e-14;
  b.inertia_at_reference(0, 1) = 1e-19;
  EXPECT_EQ(differenceOf(fingerprintOf(a), fingerprintOf(b)), "");
}

TEST(Fingerprint, EveryNumberItDependsOn_ChangesTheFingerprint) {
  const CertificateInput a = shippedLike();
  const auto difference = [&a](auto change) {
    CertificateInput b = shippedLike();
    change(b);
    return differenceOf(fingerprintOf(a), fingerprintOf(b));
  };
  const auto expect = [&](auto change, const char* words) {
    EXPECT_TRUE(contains(difference(change), words));
  };
  using In = CertificateInput;
  const char* const device = "is for other numbers of the device device, this run has changed ones";
  expect([](In& b) { b.device.axes[1].mass += 1e-9; }, device);
  expect([](In& b) { b.device.axes[1].damping += 1e-9; }, device);
  expect([](In& b) { b.device.axes[1].coulomb = 0.1; }, device);
  expect([](In& b) { b.device.axes[1].encoder_step = 2e-5; }, device);
  expect([](In& b) { b.device.axes[1].speed_limit = 1.4; }, device);
  expect([](In& b) { b.device.axes[1].effort_slew_limit = 4e3; }, device);
  expect([](In& b) { b.device.axes[0].lever_arm_m = 0.1; }, device);
  expect([](In& b) { b.device.axes[0].kind = AxisKind::kRotation; }, device);
  expect([](In& b) { b.device.output_delay_ticks = 2; }, device);
  const char* const gains = "is for other numbers of the rendering gains";
  expect([](In& b) { b.rendering.axes[0].k_pm = 1001.0; }, gains);
  expect([](In& b) { b.rendering.axes[0].k_dm = 9.0; }, gains);
  expect([](In& b) { b.rendering.axes[0].gamma = 0.31; }, gains);
  expect([](In& b) { b.rendering.axes[0].velocity_filter_hz = 31.0; }, gains);
  expect([](In& b) { b.rendering.axes[0].armature = 0.01; }, gains);
  expect([](In& b) { b.inertia_at_reference(0, 0) *= 1.0 + 1e-6; }, "numbers of the hand hand");
  expect([](In& b) { b.inertias[0](0, 1) = b.inertias[0](1, 0) = 1e-6; }, "numbers of the hand");
  expect(
      [](In& b) {
        b.walls = {{0, {1.0, 0.0}}};
        b.exercise = "bar";
      },
      "is for the exercise none, this run uses bar");
  expect([](In& b) { b.period_s = 5e-4; }, "is for 1000 Hz, this run ticks at 2000 Hz");
  expect(
      [](In& b) {
        b.device.name = "other";
        b.device.axes[0].mass = 1.0;
      },
      "is for the device device, this run uses other");
}

}  // namespace
}  // namespace wholehand::test
