#include "loop/control/bilateral_coupling.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "one_axis_gains.hpp"
#include "support/contains.hpp"
#include "support/figure.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <array>
#include <complex>
#include <optional>
#include <random>

namespace wholehand::test {
namespace {

// ---- Eq. (13), (14)

TEST(CriticalDamping, StiffnessOf2500_GivesDampingOf97Point5) {
  EXPECT_DOUBLE_EQ(criticalDamping(2500.0, 1e-3), 97.5);  // 2·50 − 2500·0.001
}

TEST(CriticalDamping, AnyStiffnessBelowRinging_MakesADoublePoleAtOneMinusTRootKp) {
  for (const double w : {0.01, 0.05, 0.3, 0.7, 0.99, 1.0}) {
    const double t = 1e-3;
    const double kp = w * w / (t * t);
    const double kd = criticalDamping(kp, t);
    // Eq. (13) with the misprint corrected: D = T⁴k_p² + 2T³k_p k_d + T²(k_d² − 4k_p), of
    // z² − (2 − T²k_p − T k_d) z + (1 − T k_d) = 0.
    const double d =
        std::pow(t, 4) * kp * kp + 2.0 * std::pow(t, 3) * kp * kd + t * t * (kd * kd - 4.0 * kp);
    EXPECT_NEAR(d, 0.0, tolerance(1e-15));
    EXPECT_NEAR((2.0 - t * t * kp - t * kd) / 2.0, 1.0 - w, tolerance(1e-14));
  }
}

// ---- gains

RenderingConfig oneAxisFile(double k_pm, std::optional<double> armature = {}) {
  RenderingConfig file;
  file.path = "r.toml";
  AxisRendering axis;
  axis.name = "x";
  axis.k_pm = k_pm;
  axis.armature = armature;
  file.axes.push_back(axis);
  return file;
}

TEST(ResolveGains, AxisThatIsHeavyEnough_GetsNoArmature) {
  const auto gains =
      orThrow(resolveGains(oneAxisFile(1000.0), AxisMatrix::Constant(1, 1, 0.25), 1e-3));
  EXPECT_EQ(gains.armature[0], 0.0);
  EXPECT_DOUBLE_EQ(gains.inertia[0], 0.25);
  EXPECT_DOUBLE_EQ(gains.filter_tau_s[0], 1.0 / (2.0 * std::numbers::pi * 30.0));
  // M k_d of Eq. (14) at k_p = K_pm / M = 4000 1/s²
  const AxisDamping damping = avatarDamping(AxisMatrix::Constant(1, 1, 0.25), gains.k_pm, 1e-3);
  EXPECT_NEAR(damping[0], 0.25 * (2.0 * std::sqrt(4000.0) - 4.0), tolerance(1e-12));
}

TEST(ResolveGains, VeryLightAxis_GetsTheMissingArmatureForFiftyThousand) {
  const auto gains =
      orThrow(resolveGains(oneAxisFile(4.0), AxisMatrix::Constant(1, 1, 4e-5), 1e-3));
  EXPECT_NEAR(gains.armature[0], 4.0 / 5e4 - 4e-5, 1e-18);
  EXPECT_NEAR(gains.inertia[0], 8e-5, 1e-18);
  // K_pm (1 + (1 − γ) k_d τ_f) / k_p with k_p = 5e4 and γ = 0.3, the model's default.
  const double k_d = 2.0 * std::sqrt(5e4) - 50.0;
  const double felt = 4.0 * (1.0 + 0.7 * k_d / (2.0 * std::numbers::pi * 30.0)) / 5e4;
  EXPECT_NEAR(feltInertia(gains, 0, 1e-3), felt, 1e-12 * felt);
}

TEST(ResolveGains, StatedArmature_IsTaken) {
  const auto gains =
      orThrow(resolveGains(oneAxisFile(4.0, 1e-4), AxisMatrix::Constant(1, 1, 4e-5), 1e-3));
  EXPECT_EQ(gains.armature[0], 1e-4);
  AxisMatrix two = AxisMatrix::Constant(2, 2, 1.0);
  AxisInertia armature(2);
  armature[1] = 0.5;
  const AxisMatrix heavier = withArmature(two, armature);
  EXPECT_EQ(heavier(0, 0), 1.0);
  EXPECT_EQ(heavier(1, 1), 1.5);
  EXPECT_EQ(heavier(0, 1), 1.0);
}

TEST(ResolveGains, StiffnessThatRings_IsRefusedWithBoundAndRate) {
  const auto of = [](double inertia) { return AxisMatrix::Constant(1, 1, inertia); };
  EXPECT_TRUE(resolveGains(oneAxisFile(1000.0, 0.0), of(1e-3), 1e-3).ok());  // exactly 1/T²
  const auto refused = resolveGains(oneAxisFile(1000.0, 0.0), of(1e-3 / 1.01), 1e-3);
  ASSERT_FALSE(refused.ok());
  const std::string text = format(refused.errors());
  EXPECT_TRUE(contains(text, "r.toml: x.armature = 0"));
  EXPECT_TRUE(contains(text, "at least 9.9e-06"));  // 1e-3 (1 − 1/1.01)
  EXPECT_TRUE(contains(text, "1005 Hz"));           // sqrt(1.01e6), rounded up
  EXPECT_TRUE(resolveGains(oneAxisFile(1000.0, 0.0), of(1e-3 / 1.01), 1.0 / 1005.0).ok());
}

TEST(ResolveGains, ImpossibleInput_IsRefused) {
  const RenderingConfig file = oneAxisFile(1000.0);
  EXPECT_FALSE(resolveGains(file, AxisMatrix::Constant(1, 1, 0.0), 1e-3).ok());
  EXPECT_FALSE(resolveGains(file, AxisMatrix::Constant(1, 1, std::nan("")), 1e-3).ok());
  EXPECT_FALSE(resolveGains(file, AxisMatrix::Identity(2, 2), 1e-3).ok());
  EXPECT_FALSE(resolveGains(file, AxisMatrix::Constant(1, 1, 0.25), 0.0).ok());
  EXPECT_FALSE(resolveGains(oneAxisFile(std::nan("")), AxisMatrix::Identity(1, 1), 1e-3).ok());
}

// ---- velocity

TEST(VelocityEstimator, FirstCall_IsZeroWhereverTheDeviceStands) {
  const VelocityState s =
      estimateVelocity({}, AxisPosition(1, 0.3), oneAxisGains(1000.0, 2500.0, 0.0), 1, 1e-3);
  EXPECT_EQ(s.filtered[0], 0.0);
  EXPECT_EQ(s.previous[0], 0.3);
  EXPECT_TRUE(s.started);
}

TEST(VelocityEstimator, StepOfVelocity_RisesAsTheLowPassSays) {
  const CouplingGains gains = oneAxisGains(1000.0, 2500.0, 0.0);
  const double tau = gains.filter_tau_s[0];
  VelocityState s = estimateVelocity({}, AxisPosition(1, 0.0), gains, 1, 1e-3);
  for (int k = 1; k <= 50; ++k) {
    s = estimateVelocity(s, AxisPosition(1, 0.2 * 1e-3 * k), gains, 1, 1e-3);
    // Backward Euler of τ v̇ = u − v: v[k] = u (1 − (τ/(τ+T))ᵏ).
    EXPECT_NEAR(s.filtered[0], 0.2 * (1.0 - std::pow(tau / (tau + 1e-3), k)), tolerance(1e-14));
  }
}

TEST(VelocityEstimator, SkippedPeriods_DoNotChangeASteadyVelocity) {
  const CouplingGains gains = oneAxisGains(1000.0, 2500.0, 0.0);
  VelocityState s = estimateVelocity({}, AxisPosition(1, 0.0), gains, 1, 1e-3);
  double t = 0.0;
  for (int k = 0; k < 400; ++k) {
    t += 1e-3;
    s = estimateVelocity(s, AxisPosition(1, 0.1 * t), gains, 1, 1e-3);
  }
  t += 7e-3;
  s = estimateVelocity(s, AxisPosition(1, 0.1 * t), gains, 7, 1e-3);
  EXPECT_NEAR(s.filtered[0], 0.1, tolerance(1e-12));
}

// ---- Eq. (2), (3) closed around a simulated avatar of one axis

/// The device follows a given path; the avatar moves by Eq. (2) and symplectic Euler, as in a tick.
struct Rig {
  CouplingGains gains;
  double period_s = 1e-3;
  VelocityState velocity = {};
  double q_s = 0.0, qd_s = 0.0;
  bool after_step = false;  ///< wrong pairing of states, to show that the test detects it

  double tick(double position) {
    const AxisPosition q_m(1, position);
    velocity = estimateVelocity(velocity, q_m, gains, 1, period_s);
    const auto felt = [&] {
      return couplingEffort(q_m, velocity.filtered, AxisPosition(1, q_s), AxisVelocity(1, qd_s),
                            dampingOf(gains), gains)[0];
    };
    const double before = felt();
    const double f = avatarEffort(q_m, velocity.filtered, AxisPosition(1, q_s),
                                  AxisVelocity(1, qd_s), dampingOf(gains), gains)[0];
    qd_s += period_s * f / gains.inertia[0];
    q_s += period_s * qd_s;
    return after_step ? felt() : before;
  }
};

TEST(BilateralCoupling, SteadyAcceleration_RendersTheMassOfTheClosedForm) {
  for (const double gamma : {0.0, 0.3, 1.0}) {
    for (const double kp : {900.0, 2500.0, 1e4}) {
      Rig rig{oneAxisGains(1000.0, kp, gamma)};
      double effort = 0.0;
      for (int k = 0; k < 2000; ++k) effort = rig.tick(0.5 * 0.7 * (k * 1e-3) * (k * 1e-3));
      // Closed form: the lag is (1 + k_d τ)/k_p, and γ removes the filter's part of it.
      const double kd = criticalDamping(kp, 1e-3);
      const double mass = 1000.0 * (1.0 + (1.0 - gamma) * kd * rig.gains.filter_tau_s[0]) / kp;
      EXPECT_NEAR(-effort / 0.7, mass, tolerance(1e-6) * mass) << "γ " << gamma << " k_p " << kp;
    }
  }
}

TEST(BilateralCoupling, SteadyFreeMotion_HasNoDragWithTheTicksPairing) {
  for (const double gamma : {0.0, 0.3, 1.0}) {
    Rig rig{oneAxisGains(1000.0, 2500.0, gamma)};
    Rig wrong{oneAxisGains(1000.0, 2500.0, gamma)};
    wrong.after_step = true;
    double effort = 0.0, wrong_effort = 0.0;
    for (int k = 0; k < 2000; ++k) {
      effort = rig.tick(0.1 * k * 1e-3);
      wrong_effort = wrong.tick(0.1 * k * 1e-3);
    }
    EXPECT_NEAR(effort, 0.0, tolerance(1e-9));
    // The pairing with the state after the step pushes the person along: −K T v.
    EXPECT_NEAR(wrong_effort, 1000.0 * 1e-3 * 0.1, tolerance(1e-9));
  }
}

TEST(BilateralCoupling, HeldAvatar_RendersTheSpring) {
  const CouplingGains gains = oneAxisGains(1000.0, 2500.0, 0.3);
  const AxisEffort f =
      couplingEffort(AxisPosition(1, 0.012), AxisVelocity(1), AxisPosition(1, 0.002),
                     AxisVelocity(1), dampingOf(gains), gains);
  EXPECT_DOUBLE_EQ(f[0], -10.0);  // 1000 N/m · 10 mm, against the person
}

TEST(BilateralCoupling, CouplingDampers_PowerHasTheSignThatGammaGives) {
  // Power that the dampers of both sides dissipate: D (v_f − v_s)² at γ = 1, and D v_s (v_s − v_f),
  // which can be negative, in the paper's law γ = 0.
  EXPECT_TRUE(rc::check("dampers", [](double raw_f, double raw_s) {
    const double vf = std::remainder(raw_f, 1.0), vs = std::remainder(raw_s, 1.0);
    RC_PRE(std::isfinite(vf) && std::isfinite(vs));
    const auto dissipated = [&](double gamma) {
      CouplingGains g = oneAxisGains(1000.0, 2500.0, gamma);
      const AxisDamping damping = dampingOf(g);
      const AxisPosition q(1, 0.0);
      const AxisVelocity rate_f(1, vf), rate_s(1, vs);
      const double on_person = couplingEffort(q, rate_f, q, rate_s, damping, g)[0];
      const double on_avatar = avatarEffort(q, rate_f, q, rate_s, damping, g)[0];
      return -(on_person * vf + on_avatar * vs);
    };
    const double b = 1000.0 * 97.5 / 2500.0;
    RC_ASSERT(std::abs(dissipated(1.0) - b * (vf - vs) * (vf - vs)) <= 1e-12 * b);
    RC_ASSERT(std::abs(dissipated(0.0) - b * vs * (vs - vf)) <= 1e-12 * b);
    RC_ASSERT(dissipated(1.0) >= -1e-12 * b);
  }));
  const CouplingGains paper = oneAxisGains(1000.0, 2500.0, 0.0);
  const AxisPosition q(1, 0.0);
  const double drive =
      avatarEffort(q, AxisVelocity(1, 0.2), q, AxisVelocity(1, 0.1), dampingOf(paper), paper)[0];
  EXPECT_GT(drive * 0.1, 0.0);  // γ = 0: the avatar receives power that nobody supplies
}

TEST(BilateralCoupling, UnitOfLength_DoesNotChangeThePhysics) {
  // The same rig in other units of length: positions times λ, inertia and gains divided by λ²,
  // so efforts are divided by λ (power is conserved).
  EXPECT_TRUE(rc::check("scaling", [] {
    const double lambda = std::exp2(*rc::gen::inRange(-8, 9));
    const auto number = [] { return *rc::gen::inRange(-1000, 1001) * 1e-3; };
    const double qm = number(), qs = number(), vm = number(), vs = number();
    CouplingGains a = oneAxisGains(1000.0, 2500.0, 0.3);
    CouplingGains b = a;
    b.k_pm[0] /= lambda * lambda;
    b.inertia[0] /= lambda * lambda;
    const auto felt = [&](const CouplingGains& g, double s) {
      return couplingEffort(AxisPosition(1, s * qm), AxisVelocity(1, s * vm),
                            AxisPosition(1, s * qs), AxisVelocity(1, s * vs), dampingOf(g), g)[0];
    };
    const auto driven = [&](const CouplingGains& g, double s) {
      return avatarEffort(AxisPosition(1, s * qm), AxisVelocity(1, s * vm), AxisPosition(1, s * qs),
                          AxisVelocity(1, s * vs), dampingOf(g), g)[0];
    };
    // The factors are powers of two, so results are equal to the last bit.
    RC_ASSERT(felt(b, lambda) * lambda == felt(a, 1.0));
    RC_ASSERT(driven(b, lambda) * lambda == driven(a, 1.0));
  }));
}

TEST(BilateralCoupling, SpringOnThePerson_EqualsTheSpringOnTheAvatar) {
  // At rest the rendered effort equals the effort on the avatar, on every axis and in every
  // posture: σ = 1.
  CouplingGains g{2,
                  AxisStiffness(2, 10.0),
                  AxisDamping(2),
                  AxisRatio(2, 0.5),
                  AxisInertia(2),
                  AxisInertia(2, 1.0),
                  AxisTime(2, 0.005)};
  g.k_pm[1] = 3.0;
  AxisPosition q_m(2), q_s(2);
  q_m[0] = 0.7, q_m[1] = 1.0, q_s[1] = 0.25;
  const AxisVelocity still(2);
  AxisMatrix inertia(2, 2);
  inertia << 1.0, 0.5, 0.5, 2.0;
  const AxisDamping damping = avatarDamping(inertia, g.k_pm, 1e-3);
  const AxisEffort f_s = avatarEffort(q_m, still, q_s, still, damping, g);
  const AxisEffort f = couplingEffort(q_m, still, q_s, still, damping, g);
  EXPECT_EQ(f_s[0], 7.0);
  EXPECT_EQ(f_s[1], 2.25);  // axes do not mix
  EXPECT_EQ(f[0], -f_s[0]);
  EXPECT_EQ(f[1], -f_s[1]);
}

TEST(ControlLaws, InTheTick_DoNotAllocate) {
  const CouplingGains gains = oneAxisGains(1000.0, 2500.0, 0.3);
  const AxisMatrix inertia = AxisMatrix::Identity(1, 1);
  const AllocationScope scope;
  const AxisDamping damping = avatarDamping(inertia, gains.k_pm, 1e-3);
  VelocityState v = estimateVelocity({}, AxisPosition(1, 0.1), gains, 1, 1e-3);
  v = estimateVelocity(v, AxisPosition(1, 0.2), gains, 1, 1e-3);
  const AxisPosition q(1, 0.2);
  const AxisVelocity qd(1, 0.1);
  const double sum = avatarEffort(q, v.filtered, q, qd, damping, gains)[0] +
                     couplingEffort(q, v.filtered, q, qd, damping, gains)[0];
  EXPECT_EQ(scope.allocations(), 0U);
  EXPECT_TRUE(std::isfinite(sum));
}

}  // namespace
}  // namespace wholehand::test
