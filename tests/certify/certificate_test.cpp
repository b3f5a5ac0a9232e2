#include "certify/certificate.hpp"

#include "certify/certificate_refusal.hpp"
#include "certify/passivity.hpp"
#include "files/device/rendering_file.hpp"
#include "files/shipped_models.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/control/reference_tables.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

namespace wholehand::test {
namespace {

/// An axis with an ideal encoder. The tables come from an independent program, which uses series
/// and Gelfand's formula where this project uses closed forms and eigenvalues.
AxisCase axisOf(double mass, double damping, int delay, double k_pm, double k_dm, double filter_hz,
                double k_ps = 2500.0, double gamma = 0.0) {
  AxisCase c;
  c.axis.name = "x";
  c.axis.mass = mass;
  c.axis.damping = damping;
  c.delay_ticks = delay;
  c.gains.name = "x";
  c.gains.k_pm = k_pm;
  c.gains.k_dm = k_dm;
  c.gains.gamma = gamma;
  c.gains.velocity_filter_hz = filter_hz;
  c.gains.armature = 0.0;
  c.inertia = k_ps > 0.0 ? k_pm / k_ps : 0.25;
  return c;
}

// StabilityFigures finds the same limits by simulation in time.
TEST(Certificate, RigidContactTable_IsReproduced) {
  for (const auto& [mass, damping, delay, table] : kRigidContactTable) {
    const AxisCertificate a = certifyAxis(axisOf(mass, damping, delay, 1000.0, 0.0, 30.0));
    EXPECT_NEAR(a.rigid_limit, table, 0.001 * table + 0.5)
        << mass << " " << damping << " " << delay;
    EXPECT_NEAR(a.rigid_formula, damping / (1e-3 * (0.5 + delay)), 1e-9 * table);
    EXPECT_NEAR(a.rigid_limit, a.rigid_formula, 0.025 * table);
  }
}

TEST(Certificate, ZWidthTable_IsReproduced) {
  for (const auto& [delay, filter_hz, table] : kDampedContactTable) {
    if (filter_hz == 0.0) continue;
    for (std::size_t i = 1; i < 6; ++i) {
      const AxisCase c = axisOf(0.5, 1.0, delay, 5000.0, kDampings[i] / 2.0, filter_hz);
      const ZWidthPoint at = zWidth(c, 2).back();
      EXPECT_DOUBLE_EQ(at.damping, kDampings[i]);
      EXPECT_NEAR(at.rigid, table[i], 0.001 * table[i] + 0.5) << delay << " " << filter_hz;
    }
  }
}

TEST(Certificate, AnyPassivePersonTable_DecidesWithinOnePercentFromBothSides) {
  struct Row {
    double k_ps;
    int delay;
    double filter_hz;
    double gamma_0, gamma_half, gamma_1;
  };
  const Row rows[] = {{400, 0, 30, 24.88, 6.22, 9.21},    {900, 1, 30, 17.05, 7.21, 13.21},
                      {2500, 0, 30, 9.88, 2.47, 4.06},    {2500, 1, 30, 10.39, 4.78, 8.36},
                      {2500, 1, 100, 10.39, 9.18, 17.36}, {10000, 0, 30, 4.88, 1.44, 2.37},
                      {10000, 1, 30, 5.41, 2.98, 4.73},   {40000, 1, 30, 2.94, 2.11, 2.95}};
  // The γ out of 0, 0.05 .. 1 that needs the smallest damping.
  const std::tuple<double, int, double, double> best[] = {
      {900, 1, 0.40, 6.26},   {2500, 0, 0.55, 2.46},  {2500, 1, 0.40, 4.07},
      {10000, 0, 0.50, 1.44}, {10000, 1, 0.35, 2.46}, {40000, 1, 0.25, 1.77}};
  for (const auto& [k_ps, delay, gamma, table] : best) {
    const AxisCase c = axisOf(0.5, 1.0, delay, 1000.0, 0.0, 30.0, k_ps, gamma);
    EXPECT_NEAR(certifyAxis(c).damping_required, table, 0.01 * table) << k_ps << " " << delay;
  }
  for (const Row& row : rows) {
    for (const auto& [gamma, table] :
         {std::pair{0.0, row.gamma_0}, {0.5, row.gamma_half}, {1.0, row.gamma_1}}) {
      for (const double side : {0.985, 1.015}) {  // the table's last digit is rounded, too
        const AxisCertificate a = certifyAxis(
            axisOf(0.5, side * table, row.delay, 1000.0, 0.0, row.filter_hz, row.k_ps, gamma));
        EXPECT_NEAR(a.damping_required, table, 0.01 * table) << row.k_ps << " γ " << gamma;
        EXPECT_EQ(a.meets(Criterion::kDamping), side > 1.0) << row.k_ps << " γ " << gamma;
      }
    }
  }
}

double radiusOf(const AxisCase& c, double phi, ContactCase contact, const char* person,
                double held_mass = 0.0) {
  AxisLoop loop = c.loop(phi);
  loop.person = armAt(c.axis, person);
  loop.held_mass = held_mass;
  return spectralRadius(closedLoopMatrix(loop, contact));
}

TEST(ClosedLoop, PersonsAndHeldMasses_EqualTheTableOfRadii) {
  struct Row {
    const char* person;
    double k_pm, k_ps;
    double radius[8];  // free, rigid, μ 1, μ 5; each at Φ = 0 and 1
  };
  const Row rows[] = {
      {"no arm", 1000, 2500, {1, 1, 1.000312, 0.993900, 1, 1, 1, 1}},
      {"relaxed arm",
       1000,
       2500,
       {0.998550, 0.996572, 0.998752, 0.995891, 0.998698, 0.997057, 0.999103, 0.998109}},
      {"stiff arm",
       1000,
       2500,
       {0.995523, 0.993867, 0.995772, 0.993464, 0.995861, 0.994576, 0.997173, 0.996512}},
      {"relaxed arm",
       3000,
       2500,
       {0.998905, 0.997657, 0.999583, 0.996904, 0.999137, 0.998206, 0.999537, 0.999066}},
      {"relaxed arm",
       3000,
       7500,
       {0.998689, 0.996773, 0.999583, 0.996904, 0.998837, 0.997204, 0.999204, 0.998168}},
      {"relaxed arm",
       300,
       900,
       {0.998369, 0.996292, 0.998460, 0.995530, 0.998474, 0.996799, 0.998905, 0.997949}}};
  for (const Row& row : rows) {
    const AxisCase c = axisOf(0.8, 1.0, 1, row.k_pm, 10.0, 30.0, row.k_ps);
    for (int i = 0; i < 8; ++i) {
      const ContactCase contact = i < 2   ? ContactCase::kFree
                                  : i < 4 ? ContactCase::kRigid
                                          : ContactCase::kObject;
      const double held = i < 4 ? 0.0 : i < 6 ? 1.0 : 5.0;
      EXPECT_NEAR(radiusOf(c, i % 2, contact, row.person, held), row.radius[i], 1e-6)
          << row.person << " " << row.k_pm << " column " << i;
    }
  }
  // The certificate reports the worst person, and only the stop is unstable.
  const AxisCertificate a = certifyAxis(axisOf(0.8, 1.0, 1, 1000.0, 10.0, 30.0));
  EXPECT_NEAR(a.contacts[1].radius, 1.000312, 1e-6);
  EXPECT_STREQ(a.contacts[1].person, "no arm");
  EXPECT_EQ(a.contacts[1].phi, 0.0);
  EXPECT_FALSE(a.meets(Criterion::kRigid));
  EXPECT_TRUE(a.meets(Criterion::kFree));
  EXPECT_FALSE(a.passes);
}

TEST(ClosedLoop, HeldMass_LimitsTheStiffnessAsInTheTable) {
  struct Row {
    double k_ps, held;
    double gamma_0, gamma_half, gamma_1, relaxed;
  };
  const Row rows[] = {
      {900, 0, 17496, 16619, 9690, 40946},    {900, 5, 4841, 12839, 7546, 12912},
      {900, 20, 2014, 12307, 7244, 6825},     {2500, 1, 15371, 22042, 14085, 36170},
      {2500, 20, 2806, 17030, 11030, 8495},   {10000, 0, 42063, 56020, 41382, 96044},
      {10000, 5, 11390, 26518, 20677, 27237}, {10000, 20, 4526, 22462, 17846, 12144}};
  for (const Row& row : rows) {
    const auto check = [&](double gamma, const char* person, double table) {
      for (const double side : {0.98, 1.02}) {
        const AxisCase c = axisOf(0.8, 1.0, 1, side * table, 0.0, 30.0, row.k_ps, gamma);
        const double radius = radiusOf(c, 0.0, ContactCase::kObject, person, row.held);
        EXPECT_EQ(radius <= 1.0 + 1e-7, side < 1.0)
            << row.k_ps << " μ " << row.held << " γ " << gamma << " " << person;
      }
    };
    check(0.0, "no arm", row.gamma_0);
    check(0.5, "no arm", row.gamma_half);
    check(1.0, "no arm", row.gamma_1);
    check(0.0, "relaxed arm", row.relaxed);
  }
}

/// The reference's random search found these passive persons and objects, just below b_min.
TEST(Certificate, WorstKnownPersonAndObject_AreUnstableJustBelowAndStableAtTheRequiredDamping) {
  struct Row {
    double gamma, worst, mass, stiffness, held, spring;
  };
  const Row rows[] = {{0.0, 9.538, 19.3, 0.0, 0.156, 2590.0},
                      {0.5, 2.238, 9.04, 0.0, 0.182, 886.0},
                      {1.0, 3.284, 0.0683, 6.75e5, 0.0149, 613.0}};
  for (const Row& row : rows) {
    AxisLoop loop = axisOf(row.mass, 0.0, 0, 1000.0, 0.0, 30.0, 2500.0, row.gamma).loop(0.0);
    loop.person.stiffness = row.stiffness;
    loop.held_mass = row.held;
    loop.spring_per_s2 = row.spring;
    loop.damping = 0.98 * row.worst;
    EXPECT_GT(spectralRadius(closedLoopMatrix(loop, ContactCase::kObject)), 1.0 + 1e-7);
    loop.damping = requiredDamping(loop);
    EXPECT_LE(spectralRadius(closedLoopMatrix(loop, ContactCase::kObject)), 1.0 + 1e-7);
  }
}

TEST(Certificate, DampedAxis_IsStableWithRandomPassivePersonsAndObjects) {
  auto rng = seededRandom(5);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const auto between = [&](double low, double high) { return low * std::pow(high / low, u(rng)); };
  for (int trial = 0; trial < cases(300); ++trial) {
    const int delay = trial % 3;
    const double phi = 0.5 * (trial % 3);
    AxisLoop loop = axisOf(between(0.05, 5.0), 0.0, delay, between(100.0, 5000.0),
                           between(0.1, 20.0), 30.0, between(400.0, 4e4), u(rng))
                        .loop(phi);
    loop.damping = std::max(1.001 * requiredDamping(loop), 1e-3);
    loop.person = {u(rng) < 0.3 ? 0.0 : between(0.01, 10.0), 0.0,
                   u(rng) < 0.3 ? 0.0 : between(1.0, 1e5)};
    loop.held_mass = u(rng) < 0.3 ? 0.0 : between(0.01, 100.0);
    loop.spring_per_s2 = u(rng) < 0.3 ? 0.0 : between(10.0, 1e6);
    EXPECT_LE(spectralRadius(closedLoopMatrix(loop, ContactCase::kObject)), 1.0 + 1e-7)
        << "trial " << trial;
  }
}

TEST(Certificate, RequiredDamping_IsLargestAtOneEndOfPhi) {
  // Convex in Φ, as a maximum of functions that are affine in Φ. The nine samples find the maximum.
  for (const double gamma : {0.0, 0.3, 1.0}) {
    const AxisCase c = axisOf(0.5, 5.0, 1, 1000.0, 20.0, 30.0, 4000.0, gamma);
    const AxisCertificate a = certifyAxis(c);
    EXPECT_TRUE(a.damping_required_phi == 0.0 || a.damping_required_phi == 1.0);
    for (int i = 0; i <= 50; ++i) {
      EXPECT_LE(requiredDamping(c.loop(i / 50.0)), a.damping_required * (1.0 + 1e-12));
    }
  }
}

TEST(Certificate, Quantisation_IsTheSmallerOfViscousAndDryFriction) {
  AxisCase c = axisOf(0.8, 6.0, 1, 1000.0, 10.0, 30.0, 0.0, 0.3);
  EXPECT_DOUBLE_EQ(certifyAxis(c).quantisationLimit(), 12000.0);  // 2 b / T; ideal encoder
  c.axis.encoder_step = 1e-4;
  EXPECT_DOUBLE_EQ(certifyAxis(c).quantisationLimit(), 12000.0);  // dry friction not stated
  c.axis.coulomb = 0.2;
  EXPECT_DOUBLE_EQ(certifyAxis(c).quantisationLimit(), 4000.0);  // 2 f_c / Δ
  EXPECT_TRUE(certifyAxis(c).passes);
  c.axis.encoder_step = 4.1e-4;  // 976 < 1000
  const AxisCertificate a = certifyAxis(c);
  EXPECT_FALSE(a.passes);
  EXPECT_EQ(a.binding, Criterion::kQuantisation);
  EXPECT_NEAR(a.margin, 0.4 / 4.1e-4 / 1000.0, 1e-12);
}

TEST(Certificate, ArmOnARotation_IsScaledByTheLeverArmSquared) {
  DeviceAxis axis;
  axis.kind = AxisKind::kRotation;
  axis.lever_arm_m = 0.05;
  const Impedance arm = armAt(axis, "stiff arm");
  EXPECT_DOUBLE_EQ(arm.mass, 1.5 * 0.0025);
  EXPECT_DOUBLE_EQ(arm.damping, 20.0 * 0.0025);
  EXPECT_DOUBLE_EQ(arm.stiffness, 600.0 * 0.0025);
  EXPECT_EQ(armAt(axis, "no arm").mass, 0.0);
}

struct Shipped {
  const char* name;  ///< of the device and its gains
  const char* hand;
};

class ShippedGains : public testing::TestWithParam<Shipped> {
 protected:
  void SetUp() override {
    const std::string name = GetParam().name;
    device_ = deviceNamed(name);
    rendering_ = orThrow(loadRenderingFile(kConfig + "rendering/" + name + ".toml", device_));
    hand_ = handNamed(GetParam().hand, name);
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
  const auto gains = orThrow(resolveGains(rendering_, inertiaAt(hand_.reference), 1e-3));
  for (int a = 0; a < device_.axisCount(); ++a) {
    if (device_.axes[a].kind != AxisKind::kTranslation) continue;
    EXPECT_EQ(gains.armature[a], 0.0) << device_.axes[a].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Config, ShippedGains,
                         testing::Values(Shipped{"lambda-pride", "adult-median-right"},
                                         Shipped{"lambda-pride", "woman-p05-right"},
                                         Shipped{"lambda-pride", "man-p95-right"},
                                         Shipped{"desktop-3axis", "adult-median-left"},
                                         Shipped{"wrist-9axis", "adult-median-right"}));

}  // namespace
}  // namespace wholehand::test
