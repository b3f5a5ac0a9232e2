#include "certify/stability.hpp"

#include "certify/passivity.hpp"
#include "loop/control/axis_loop.hpp"
#include "loop/control/bilateral_coupling.hpp"
#include "loop/control/one_axis_gains.hpp"
#include "loop/control/reference_tables.hpp"
#include "support/constants.hpp"
#include "support/seed.hpp"

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace wholehand::test {
namespace {

double radius(const AxisLoop& l, ContactCase contact) {
  return spectralRadius(closedLoopMatrix(l, contact));
}

/// Largest stable stiffness of a rigid contact, by bisection on the logarithm.
double largestStiffness(AxisLoop l) {
  double low = 1.0, high = 1e6;
  for (int i = 0; i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    l.k_pm = middle;
    (radius(l, ContactCase::kRigid) < 1.0 + 2e-7 ? low : high) = middle;
  }
  return low;
}

TEST(ClosedLoop, DampedRigidContact_EqualsReferenceTable) {
  for (const auto& [delay, filter_hz, table] : kDampedContactTable) {
    for (std::size_t i = 0; i < 6; ++i) {
      const double k = largestStiffness(loopOf(0.5, 1.0, delay, 1.0, kDampings[i], filter_hz));
      EXPECT_NEAR(k, table[i], 0.001 * table[i] + 0.5)
          << "n " << delay << " filter " << filter_hz << " ΦK_dm " << kDampings[i];
    }
  }
}

TEST(ClosedLoop, NonFiniteGain_IsInfinitelyUnstable) {
  EXPECT_EQ(radius(loopOf(0.8, 1.0, 1, std::nan(""), 0.0, 30.0), ContactCase::kFree), HUGE_VAL);
}

TEST(ClosedLoop, VanishingDeviceDamping_HasTheLimitOfTheExactHold) {
  const Eigen::MatrixXd none =
      closedLoopMatrix(loopOf(0.5, 0.0, 1, 1e3, 1.0, 30.0), ContactCase::kFree);
  for (const double b : {1e-12, 1e-3, 0.00499, 0.00501}) {  // both sides of the series' range
    const Eigen::MatrixXd some =
        closedLoopMatrix(loopOf(0.5, b, 1, 1e3, 1.0, 30.0), ContactCase::kFree);
    // x += T²/2m (1 − bT/3m ..) f: first order in bT/m.
    EXPECT_LE((some - none).cwiseAbs().maxCoeff(), b * 1e-3 / 0.5 * 1.01);
  }
  const auto push = [](double b) {
    return closedLoopMatrix(loopOf(0.5, b, 1, 1e3, 1.0, 30.0), ContactCase::kFree)(0, 6);
  };
  EXPECT_NEAR(push(0.00499), 1e-6 * (0.5 - 0.00499e-3 / 0.5 / 6.0) / 0.5, 1e-15);
  EXPECT_NEAR(push(0.00501), 1e-6 * (0.5 - 0.00501e-3 / 0.5 / 6.0) / 0.5, 1e-15);
}

/// The certificate must describe the loop that runs: the matrix is compared with the tick's own
/// functions on a device integrated in ten thousand small steps per period.
TEST(ClosedLoop, PowersOfTheMatrix_EqualTheTicksFunctions) {
  const double mass = 0.8, damping = 6.0, k_dm = 10.0, phi = 0.6;
  const CouplingGains gains = oneAxisGains(1000.0, 3900.0, 0.3);
  const AxisLoop l = loopOf(mass, damping, 2, 1000.0, phi * k_dm, 30.0, 3900.0, 0.3);
  const Eigen::MatrixXd matrix = closedLoopMatrix(l, ContactCase::kFree);

  double x = 0.01, v = -0.2, q_s = 0.004, qd_s = 0.1;
  double queue[2] = {0.0, 0.0};
  VelocityState velocity{AxisPosition(1, x), AxisVelocity(1, 0.0), true};
  Eigen::VectorXd state = Eigen::VectorXd::Zero(8);
  state << x, v, x, 0.0, q_s, qd_s, 0.0, 0.0;
  for (int k = 0; k < 40; ++k) {
    const AxisPosition q_m(1, x);
    velocity = estimateVelocity(velocity, q_m, gains, 1, 1e-3);
    const AxisPosition avatar(1, q_s);
    const AxisVelocity avatar_rate(1, qd_s);
    const double sent =
        couplingEffort(q_m, velocity.filtered, avatar, avatar_rate, dampingOf(gains), gains)[0] -
        phi * k_dm * velocity.filtered[0];
    const double a =
        avatarEffort(q_m, velocity.filtered, avatar, avatar_rate, dampingOf(gains), gains)[0] /
        gains.inertia[0];
    qd_s += 1e-3 * a;
    q_s += 1e-3 * qd_s;
    const double felt = queue[0];
    queue[0] = queue[1];
    queue[1] = sent;
    for (int i = 0; i < 10000; ++i) {  // midpoint rule
      const double middle = v + 0.5e-7 * (felt - damping * v) / mass;
      v += 1e-7 * (felt - damping * middle) / mass;
      x += 1e-7 * middle;
    }
    state = (matrix * state).eval();
    EXPECT_NEAR(state[0], x, 1e-12);
    EXPECT_NEAR(state[1], v, 1e-10);
    EXPECT_NEAR(state[4], q_s, 1e-12);
    EXPECT_NEAR(state[5], qd_s, 1e-10);
  }
}

// ---- several axes

TEST(AvatarLoop, OneAxis_IsStableUpToTwiceTheLoopRate) {
  for (const double w : {1.98, 2.02}) {  // w = T √(K/M); Jury: K/M < 4/T²
    const double r = spectralRadius(avatarLoopMatrix(AxisMatrix::Constant(1, 1, 0.3),
                                                     AxisStiffness(1, 0.3 * w * w * 1e6), 1e-3));
    EXPECT_EQ(r < 1.0, w < 2.0) << r;
  }
}

TEST(AvatarLoop, CoupledAxes_AreStableWhereTheMatrixConditionHolds) {
  // The condition is 4 M − 2 T D − T² K positive definite. A mode u has the polynomial (z − 1)² m +
  // T (z − 1) d + T² z k, which by Jury's conditions is stable for 4 m − 2 T d − T² k > 0. Where
  // the smallest eigenvector of that matrix is no mode, the loop may be stable slightly beyond. It
  // is never unstable below, and a mode that all axes share oscillates at the bound itself.
  auto rng = seededRandom(11);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < cases(50); ++trial) {
    const int n = 2 + trial % 6;
    Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(n, n, [&] { return normal(rng); });
    const AxisMatrix inertia = a * a.transpose() + 0.05 * Eigen::MatrixXd::Identity(n, n);
    AxisStiffness shape(n);
    for (int i = 0; i < n; ++i)
      shape[i] = inertia(i, i);  // the same k_p for all axes: D and K are proportional
    const auto least = [&](double factor) {
      AxisStiffness k_pm = shape;
      k_pm.vec() *= factor;
      const Eigen::MatrixXd left =
          4.0 * Eigen::MatrixXd(inertia) -
          2e-3 * Eigen::MatrixXd(avatarDamping(inertia, k_pm, 1e-3).vec().asDiagonal()) -
          1e-6 * Eigen::MatrixXd(k_pm.vec().asDiagonal());
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(left).eigenvalues().minCoeff();
    };
    double low = 0.0, high = 3.9e6;  // 1/T² times (2 w below Nyquist)²
    for (int i = 0; i < 60; ++i)
      (least(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
    for (const double side : {0.98, 1.02}) {
      AxisStiffness k_pm = shape;
      k_pm.vec() *= side * low;
      EXPECT_EQ(spectralRadius(avatarLoopMatrix(inertia, k_pm, 1e-3)) < 1.0, side < 1.0);
    }
  }
}

TEST(RequiredDamping, PaperLaw_TendsToItsLimitAtFrequencyZero) {
  // Closed form at frequency zero, γ = 0, n = 0: K T/2 + K (k_d − k_p T)² / (4 k_p (k_d − k_p
  // T/2)).
  const double kp = 2500.0, kd = criticalDamping(kp, 1e-3);
  const double e = kd - kp * 1e-3;
  const double limit = 1000.0 * (0.5e-3 + e * e / (4.0 * kp * (kd - kp * 0.5e-3)));
  EXPECT_NEAR(requiredDamping(loopOf(0.5, 1.0, 0, 1000.0, 0.0, 30.0, kp)), limit, 1e-3 * limit);
}

TEST(RequiredDamping, AvatarThatIsItselfActive_NeedsInfiniteDamping) {
  AxisLoop l = loopOf(0.5, 1.0, 0, 1000.0, 0.0, 30.0);
  l.k_ds_per_s = 1.0;  // below T k_p / 2 = 1.25
  EXPECT_EQ(requiredDamping(l), HUGE_VAL);
}

// Why the effort is written before the world is stepped (docs/adr/0002-step-after-device-write.md).

constexpr double kMass_kg = 0.4, kDamping_n_s_m = 2.0;

/// Exact motion of m v' = f - b v over a time, as a matrix on [x, v, f].
Eigen::Matrix3d held(double time_s) {
  const double rate_per_s = kDamping_n_s_m / kMass_kg;
  const double travel_s = (1.0 - std::exp(-rate_per_s * time_s)) / rate_per_s;
  Eigen::Matrix3d out = Eigen::Matrix3d::Identity();
  out.row(0) << 1.0, travel_s, (time_s - travel_s) / kDamping_n_s_m;
  out.row(1) << 0.0, std::exp(-rate_per_s * time_s), travel_s / kMass_kg;
  return out;
}

/// One period of a device on a spring to a rigid stop. The effort computed from the position at the
/// period's start arrives `late_s` after it.
Eigen::Matrix3d onePeriod(double stiffness_n_m, double late_s) {
  Eigen::Matrix3d computed = Eigen::Matrix3d::Zero();
  computed(2, 0) = -stiffness_n_m;  // position at the start of the period
  const Eigen::Matrix3d until = held(late_s);
  Eigen::Matrix3d renewed = until;
  renewed.row(2) = computed.row(2);
  return held(kPeriod_s - late_s) * renewed;
}

double largestStable(double late_s) {
  double stable = 1.0, unstable = 1e5;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (stable + unstable);
    (spectralRadius(onePeriod(middle, late_s)) < 1.0 ? stable : unstable) = middle;
  }
  return stable;
}

TEST(TickOrder, EffortWrittenAfterThePhysicsStep_LowersTheStableStiffness) {
  constexpr double kWrite_s = 0.02e-3;  // duration of the write itself
  double before_n_m = largestStable(kWrite_s);
  for (const double step_s : {0.0, 0.1e-3, 0.4e-3, 0.8e-3}) {
    const double stable_n_m = largestStable(kWrite_s + step_s);
    std::printf("figure: largest stable stiffness, effort written %.1f ms later = %.0f N/m\n",
                step_s * 1e3, stable_n_m);
    // The sampled-data limit of a rigid contact, K < b / (T/2 + delay).
    const double limit_n_m = kDamping_n_s_m / (0.5 * kPeriod_s + kWrite_s + step_s);
    EXPECT_NEAR(stable_n_m, limit_n_m, 0.02 * limit_n_m);
    if (step_s > 0.0) {
      EXPECT_LT(stable_n_m, 0.9 * before_n_m);
    }
    before_n_m = stable_n_m;
  }
}

}  // namespace
}  // namespace wholehand::test
