// The rendered impedance, compared with closed forms of its limits, with the certificate's
// closed-loop matrix and with the simulated device.
#include "certify/impedance.hpp"

#include "loop/control/axis_loop.hpp"
#include "loop/device/simulated/axis_dynamics.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

#include <Eigen/LU>

#include <cmath>

namespace wholehand::test {
namespace {

double omega(double frequency_hz) {
  return 2.0 * std::numbers::pi * frequency_hz;
}

/// The x axis of the shipped robot, to three digits.
AxisLoop robot() {
  return loopOf(0.8, 6.0, 1, 1000.0, 0.0, 30.0, 4000.0, 0.3);
}

Complex felt(const AxisLoop& loop, ContactCase contact, double frequency_hz) {
  return feltImpedance(feltUncoupled(loop), contact, frequency_hz).felt;
}

/// Rendered mass: the resistance to a slow acceleration.
double feltMass(Complex z, double frequency_hz) {
  return z.imag() / omega(frequency_hz);
}

/// Rendered stiffness: effort in phase with the position, Re jωZ.
double feltStiffness(Complex z, double frequency_hz) {
  return -z.imag() * omega(frequency_hz);
}

TEST(FeltImpedance, SlowFreeMotion_IsTheMassOfDeviceAndCoupling) {
  // science.md 1.1: at an acceleration a the avatar lags by a (1 + k_d τ)/k_p; γ returns its share
  // of the filter's lag.
  for (const double gamma : {0.0, 0.3, 1.0}) {
    AxisLoop l = robot();
    l.gamma = gamma;
    const double coupling =
        l.k_pm * (1.0 + (1.0 - gamma) * l.k_ds_per_s * l.filter_tau_s) / l.k_ps_per_s2;
    const Complex z = felt(l, ContactCase::kFree, 0.05);
    EXPECT_NEAR(feltMass(z, 0.05), l.mass + coupling, tolerance(1e-3) * (l.mass + coupling));
    EXPECT_NEAR(z.real(), l.damping, tolerance(1e-3) * l.damping);  // the coupling adds no drag
  }
}

TEST(FeltImpedance, SlowFreeMotionAtFullPhi_IsDampedByKdm) {
  AxisLoop l = robot();
  l.phi_k_dm = 10.0;
  EXPECT_NEAR(felt(l, ContactCase::kFree, 0.05).real(), l.damping + 10.0, tolerance(1e-3) * 16.0);
}

TEST(FeltImpedance, SlowRigidContact_IsTheCouplingsStiffness) {
  // At 0.01 Hz the device's mass contributes 3e-3 N/m.
  const Complex z = felt(robot(), ContactCase::kRigid, 0.01);
  EXPECT_NEAR(feltStiffness(z, 0.01), 1000.0, tolerance(1e-4) * 1000.0);
}

TEST(FeltImpedance, SlowContactWithASpring_IsBothSpringsInSeries) {
  // The avatar rests where m_a k_p (x − q) = k_o q, and K_pm (x − q) is rendered, so that with σ =
  // K_pm / (k_p m_a): 1/k = 1/K_pm + 1/(σ k_o). Here σ = 2, m_a = 0.125 kg, k_o = 700 N/m.
  AxisLoop l = robot();
  const double sigma = 2.0, avatar_kg = l.k_pm / (l.k_ps_per_s2 * sigma), spring = 700.0;
  l.spring_per_s2 = spring / avatar_kg;
  const double expected = 1.0 / (1.0 / l.k_pm + 1.0 / (sigma * spring));
  const Complex z = felt(l, ContactCase::kObject, 0.01);
  EXPECT_NEAR(feltStiffness(z, 0.01), expected, tolerance(1e-4) * expected);
}

TEST(FeltImpedance, SlowMotionWithAHeldMass_AddsSigmaTimesTheMass) {
  // science.md 1.1: rendered object mass = σ m_o.
  AxisLoop l = robot();
  const double without = feltMass(felt(l, ContactCase::kFree, 0.05), 0.05);
  const double sigma = 2.0, avatar_kg = l.k_pm / (l.k_ps_per_s2 * sigma), object_kg = 0.3;
  l.held_mass = object_kg / avatar_kg;
  const double with = feltMass(felt(l, ContactCase::kObject, 0.05), 0.05);
  EXPECT_NEAR(with - without, sigma * object_kg, tolerance(2e-3) * sigma * object_kg);
}

TEST(FeltImpedance, DeviceAlone_IsMassAndDamping) {
  AxisLoop l = robot();
  l.k_pm = 0.0;
  const FeltImpedance z = feltImpedance(feltUncoupled(l), ContactCase::kFree, 40.0);
  EXPECT_NEAR(std::abs(z.felt - Complex(6.0, 0.8 * omega(40.0))), 0.0, tolerance(1e-9));
  EXPECT_EQ(std::abs(z.rendered), 0.0);
}

/// The same by the certificate's closed-loop matrix A: a sine that moves the bare device through
/// s_c(t) adds z s_c − A_device s_c in every period, so s = (z − A)⁻¹ of that.
Complex byMatrix(const AxisLoop& l, ContactCase contact, double frequency_hz) {
  const Eigen::MatrixXd a = closedLoopMatrix(l, contact);
  const Complex s(0.0, omega(frequency_hz)), z = std::exp(s * l.period_s);
  const Complex x = 1.0 / (s * (l.mass * s + l.damping)), v = s * x;
  Eigen::VectorXcd push = Eigen::VectorXcd::Zero(a.rows());
  push[0] = (z - 1.0) * x - a(0, 1) * v;
  push[1] = (z - a(1, 1)) * v;
  const Eigen::MatrixXcd resolvent =
      z * Eigen::MatrixXcd::Identity(a.rows(), a.rows()) - a.cast<Complex>();
  const Eigen::VectorXcd state = resolvent.fullPivLu().solve(push);
  return 1.0 / (s * state[0]);
}

TEST(FeltImpedance, AnyLoop_AgreesWithTheClosedLoopMatrix) {
  auto random = seededRandom(41);
  const auto between = [&](double low, double high) {
    return low * std::pow(high / low, std::uniform_real_distribution<double>(0.0, 1.0)(random));
  };
  double worst = 0.0;
  for (int i = 0; i < cases(300); ++i) {
    AxisLoop l = robot();
    l.mass = between(0.1, 3.0);
    l.damping = between(0.1, 500.0);
    l.delay_ticks = static_cast<int>(random() % 5);
    l.k_pm = between(100.0, 4000.0);
    l.gamma = between(0.1, 1.0);
    l.phi_k_dm = between(0.1, 20.0);
    l.period_s = between(1e-4, 2e-3);
    l.k_ps_per_s2 = between(400.0, 4e4);
    l.k_ds_per_s = criticalDamping(l.k_ps_per_s2, l.period_s);
    l.held_mass = between(0.1, 10.0);
    l.spring_per_s2 = between(100.0, 1e5);
    for (const ContactCase c : {ContactCase::kFree, ContactCase::kRigid, ContactCase::kObject}) {
      const double frequency_hz = between(0.1, 0.499 / l.period_s);
      const Complex expected = byMatrix(l, c, frequency_hz);
      worst = std::max(worst, std::abs(felt(l, c, frequency_hz) / expected - 1.0));
    }
  }
  figure("felt impedance against the closed-loop matrix, worst share", worst, "");
  EXPECT_LE(worst, tolerance(1e-6));
}

TEST(FeltImpedance, AxesNotCoupledByInertia_HaveTheImpedanceOfOneAxis) {
  FeltLoop three = feltUncoupled(robot());
  three.inertia = AxisMatrix::Zero(3, 3);
  three.inertia.diagonal() << 0.1, 0.25, 0.3;
  three.axis = 1;
  for (int a = 0; a < 3; ++a) {
    if (a == 0) {
      three.k_pm = AxisStiffness(3);
      three.avatar_damping = AxisDamping(3);
    }
    three.k_pm[a] = three.inertia(a, a) * robot().k_ps_per_s2;
    three.avatar_damping[a] = three.inertia(a, a) * robot().k_ds_per_s;
  }
  const Complex alone = felt(robot(), ContactCase::kFree, 20.0);
  const Complex coupled = feltImpedance(three, ContactCase::kFree, 20.0).felt;
  EXPECT_NEAR(std::abs(coupled / alone - 1.0), 0.0, tolerance(1e-12));
  three.inertia(0, 1) = three.inertia(1, 0) = 0.1;  // coupled inertia does change it
  const Complex shaken = feltImpedance(three, ContactCase::kFree, 20.0).felt;
  EXPECT_GT(std::abs(shaken / alone - 1.0), 0.01);
}

TEST(LinearHold, SimulatedDeviceUnderRamps_MovesByItsGain) {
  // The exact device under linear interpolation of a sampled sine, after its transient.
  AxisLoop l = robot();
  for (const double frequency_hz : {1.0, 20.0, 100.0, 400.0}) {
    AxisDynamics device({l.mass, l.damping, 0.0, 0.0, -10.0, 10.0}, l.period_s);
    constexpr int kSettle = 6000, kWindow = 1000;  // the time constant m/b is 133 ticks
    const double turn = omega(frequency_hz) * l.period_s;
    Complex phasor = 0.0;
    for (int k = 0; k < kSettle + kWindow; ++k) {
      if (k >= kSettle) phasor += 2.0 / kWindow * device.position() * std::polar(1.0, -turn * k);
      device.advance({std::cos(turn * k), std::cos(turn * (k + 1))});
    }
    const Complex s(0.0, omega(frequency_hz));
    const Complex measured = phasor * s * (l.mass * s + l.damping);
    const Complex gain = linearHoldGain(l, frequency_hz);
    EXPECT_NEAR(std::abs(measured / gain - 1.0), 0.0, tolerance(1e-6)) << frequency_hz << " Hz";
    const double half = 0.5 * turn, sinc = std::sin(half) / half;
    if (frequency_hz <= 100.0) {
      EXPECT_NEAR(std::abs(gain), sinc * sinc, tolerance(1e-3));
    }
  }
}

}  // namespace
}  // namespace wholehand::test
