// Persons and objects that link the axes. The criterion is compared with that of a single axis,
// with terminations built at its own worst frequency, and with simulated loops with random
// terminations.
#include "certify/passivity.hpp"
#include "certify/stability.hpp"
#include "loop/control/axis_loop.hpp"
#include "loop/device/simulated/axis_dynamics.hpp"
#include "support/constants.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace wholehand::test {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

struct CoupledDraw {
  std::mt19937_64 random;
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
  }
  double spread(double low, double high) {  // uniform on the logarithm
    return std::exp(between(std::log(low), std::log(high)));
  }
  /// Positive semidefinite, of random rank from 1 on and of about that size.
  Matrix semidefinite(int n, double size) {
    const int rank = 1 + static_cast<int>(random() % static_cast<unsigned>(n));
    const Matrix a = Matrix::NullaryExpr(n, rank, [this] { return between(-1.0, 1.0); });
    return size * a * a.transpose();
  }
};

/// Axes of about a kilogram with an avatar that couples them.
CoupledCase drawCase(CoupledDraw& draw, int n) {
  CoupledCase c;
  c.delay_ticks = static_cast<int>(draw.random() % 3);
  c.period_s = kPeriod_s;
  for (int i = 0; i < n; ++i) {
    AxisCase a;
    a.axis.mass = draw.spread(0.2, 3.0);
    a.axis.damping = 1.0;
    a.delay_ticks = c.delay_ticks;
    a.period_s = kPeriod_s;
    a.gains.k_pm = draw.spread(100.0, 3000.0);
    a.gains.k_dm = draw.between(0.0, 15.0);
    a.gains.gamma = draw.between(0.0, 1.0);
    a.gains.velocity_filter_hz = draw.spread(15.0, 100.0);
    a.inertia = a.gains.k_pm / draw.spread(500.0, 2e4);
    c.axes.push_back(a);
  }
  AxisMatrix inertia = AxisMatrix::Zero(n, n);
  for (int i = 0; i < n; ++i) inertia(i, i) = c.axes[i].inertia;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) {
      inertia(i, k) = inertia(k, i) =
          draw.between(-0.4, 0.4) * std::sqrt(inertia(i, i) * inertia(k, k));
    }
  }
  c.inertias = {inertia};
  return c;
}

AxisStiffness stiffnessOf(const CoupledCase& c) {
  AxisStiffness out(static_cast<int>(c.axes.size()));
  for (int i = 0; i < out.size(); ++i) out[i] = c.axes[i].gains.k_pm;
  return out;
}

TEST(CoupledPassivity, OneAxis_NeedsItsSingleAxisDamping) {
  CoupledDraw draw{seededRandom(301)};
  double worst = 0.0;
  for (int trial = 0; trial < cases(60); ++trial) {
    CoupledCase c = drawCase(draw, 1);
    if (draw.between(0.0, 1.0) < 0.5) c.axes[0].walls = {{200.0, 0.5}};
    double expected = 0.0;  // passivity.hpp, at the corners of Φ and α
    for (const double phi : {0.0, 1.0}) {
      expected = std::max(expected, requiredDamping(c.axes[0].loop(phi)));
      for (const WallCase& wall : c.axes[0].walls) {
        expected = std::max(expected, requiredDamping(c.axes[0].loopIn(wall, 1.0, phi)));
      }
    }
    const double found = requiredShare(c).share * c.axes[0].axis.damping;
    worst = std::max(worst, std::abs(found / expected - 1.0));
  }
  figure("coupled criterion of one axis against b_min, worst share", worst, "");
  EXPECT_LE(worst, 1e-4);  // near rest 1 - cos φ leaves 5 digits of either
}

TEST(CoupledPassivity, UncoupledAxes_NeedAtLeastTheLargestOfEach) {
  CoupledDraw draw{seededRandom(302)};
  for (int trial = 0; trial < cases(20); ++trial) {
    CoupledCase c = drawCase(draw, 3);
    c.inertias[0] = AxisMatrix(c.inertias[0].diagonal().asDiagonal());
    double most = 0.0;
    for (const AxisCase& a : c.axes) {
      most = std::max({most, requiredDamping(a.loop(0.0)), requiredDamping(a.loop(1.0))});
    }
    EXPECT_GE(requiredShare(c).share, most * (1.0 - 1e-4));
  }
}

/// This criterion covers more persons, so it never needs less than that of linear persons.
TEST(CoupledPassivity, AnyPerson_NeedsAtLeastTheDampingOfLinearOnes) {
  CoupledDraw draw{seededRandom(305)};
  std::vector<double> ratios;
  for (int trial = 0; trial < cases(60); ++trial) {
    CoupledCase c = drawCase(draw, 1 + static_cast<int>(draw.random() % 4));
    const double linear = requiredShare(c).share;
    c.persons = Persons::kAny;
    ratios.push_back(requiredShare(c).share / linear);
    EXPECT_GE(ratios.back(), 1.0 - 1e-4) << "case " << trial;
  }
  std::sort(ratios.begin(), ratios.end());
  figure("damping that any person needs, of that for linear ones, median",
         ratios[ratios.size() / 2], "");
  figure("the same, most", ratios.back(), "");
}

/// The terms of certify/passivity.hpp, written independently.
struct Terms {
  Eigen::VectorXcd free, felt, driven;
  Eigen::MatrixXcd avatar;
};

Terms termsOf(const CoupledCase& c, double angle_rad, double phi) {
  const auto n = static_cast<Eigen::Index>(c.axes.size());
  const Complex z = std::polar(1.0, angle_rad);
  const Complex late = std::pow(z, -c.delay_ticks);
  const AxisDamping damping = avatarDamping(c.inertias[0], stiffnessOf(c), kPeriod_s);
  Terms t{Eigen::VectorXcd(n), Eigen::VectorXcd(n), Eigen::VectorXcd(n),
          Matrix(c.inertias[0]).cast<Complex>() * (1.0 - 1.0 / z) / kPeriod_s};
  for (Eigen::Index i = 0; i < n; ++i) {
    const AxisRendering& g = c.axes[i].gains;
    const double d = damping[static_cast<int>(i)];
    const double tau_s = 1.0 / (2.0 * std::numbers::pi * g.velocity_filter_hz);
    const Complex slope = (z - 1.0) / ((tau_s + kPeriod_s) * z - tau_s);
    const Complex integral = kPeriod_s / (z - 1.0);
    t.free[i] = integral * late * (g.k_pm + (g.gamma * d + phi * g.k_dm) * slope);
    t.felt[i] = late * (g.k_pm * integral + g.gamma * d / z);
    t.driven[i] = integral * (g.k_pm + d * slope);
    t.avatar(i, i) += g.k_pm * integral + d / z;
  }
  return t;
}

/// At the worst frequency there is a passive person W x = u and a passive object Z y = v with which
/// the loop oscillates undamped at exactly the damping that is reported as needed: Re xᴴu and Re
/// yᴴv are not negative (such W and Z then exist). With 2 % more damping they do not exist.
TEST(CoupledPassivity, WorstPersonAndObject_ExistAtTheRequiredDamping) {
  CoupledDraw draw{seededRandom(303)};
  double worst = 1.0;
  for (int trial = 0; trial < cases(40); ++trial) {
    CoupledCase c = drawCase(draw, 2 + trial % 3);
    for (AxisCase& a : c.axes) a.gains.k_dm = 0.0;
    const RequiredShare need = requiredShare(c);
    if (!std::isfinite(need.share)) continue;
    const Terms t = termsOf(c, 2.0 * std::numbers::pi * need.frequency_hz * kPeriod_s, 0.0);
    const Matrix real = t.avatar.real();
    const double lambda = need.lambda;
    const Eigen::VectorXcd e = t.felt + lambda * t.driven.conjugate();
    const auto left = [&](double b) {
      const Eigen::MatrixXcd inverse = real.inverse().cast<Complex>() / (4.0 * lambda);
      Eigen::MatrixXcd out = -(e.asDiagonal() * inverse * e.conjugate().asDiagonal());
      out.diagonal().array() += b + t.free.real().array();
      return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd>(out);
    };
    // The damping of all axes is 1, so the share is the damping. The null vector is the
    // oscillation; where two axes need the same at this λ there are two, and a mixture of them is
    // the oscillation.
    const auto vectors = left(need.share).eigenvectors();
    double bears = 0.0;
    for (int degrees = 0; degrees < 360; ++degrees) {
      const double angle = degrees * std::numbers::pi / 360.0;
      for (const Complex turn : {Complex(1.0, 0.0), Complex(0.0, 1.0)}) {
        const Eigen::VectorXcd x =
            std::cos(angle) * vectors.col(0) + std::sin(angle) * turn * vectors.col(1);
        const Eigen::VectorXcd y = real.inverse().cast<Complex>() *
                                   (e.conjugate().asDiagonal() * x).eval() / (2.0 * lambda);
        const Eigen::VectorXcd driven = t.driven.asDiagonal() * x;
        const double object =
            y.dot(driven - t.avatar * y).real() / (std::abs(y.dot(driven)) + 1e-300);
        if (object < -2e-3) continue;  // the object would have to give energy
        // Damping that this oscillation tolerates with a person who dissipates nothing: Re xᴴ W x =
        // 0.
        const Eigen::VectorXcd felt = t.felt.asDiagonal() * y, free = t.free.asDiagonal() * x;
        bears = std::max(bears, x.dot(felt - free).real() / x.squaredNorm());
      }
    }
    worst = std::min(worst, bears / need.share);
    EXPECT_GT(left(1.02 * need.share).eigenvalues()[0], 0.0);
  }
  figure("damping at which the worst coupled person and object swing, of what is needed", worst,
         "");
  EXPECT_GT(worst, 0.95);
}

/// The closed loop with a person and an object of full matrices, computed from unit states: device
/// and person by the exact exponential under a constant effort, avatar and object implicitly at
/// velocity level.
struct Terminations {
  Matrix mass, damping, stiffness;         ///< person
  Matrix held_mass, held_damping, spring;  ///< object, on the avatar's coordinates
  Matrix ties;                             ///< rows J with J q̇_s = 0; may have none
};

Matrix loopWith(const CoupledCase& c, const Terminations& t, double phi, const AxisRatio& sigma) {
  const auto n = static_cast<Eigen::Index>(c.axes.size());
  const Eigen::Index delay = c.delay_ticks, size = n * (6 + delay);
  Matrix mass = t.mass, damping = t.damping;
  for (Eigen::Index i = 0; i < n; ++i) {
    mass(i, i) += c.axes[i].axis.mass;
    damping(i, i) += c.axes[i].axis.damping;
  }
  Matrix rate = Matrix::Zero(3 * n, 3 * n);
  rate.block(0, n, n, n).setIdentity();
  const Matrix inverse = mass.inverse();
  rate.block(n, 0, n, n) = -inverse * t.stiffness;
  rate.block(n, n, n, n) = -inverse * damping;
  rate.block(n, 2 * n, n, n) = inverse;
  const Matrix held = matrixExponential(rate * kPeriod_s);
  const AxisDamping own = avatarDamping(c.inertias[0], stiffnessOf(c), kPeriod_s);
  const double h = kPeriod_s;
  const Matrix implicit =
      Matrix(c.inertias[0]) + t.held_mass + h * t.held_damping + h * h * t.spring;
  const Matrix free = implicit.inverse();
  Matrix tied = Matrix::Identity(n, n);
  if (t.ties.rows() > 0) {
    const Matrix through = t.ties * free * t.ties.transpose();
    tied -= free * t.ties.transpose() * through.ldlt().solve(t.ties);
  }
  Matrix out(size, size);
  for (Eigen::Index column = 0; column < size; ++column) {
    const Vector s = Vector::Unit(size, column);
    const Vector x = s.segment(0, n), v = s.segment(n, n), before = s.segment(2 * n, n),
                 filtered = s.segment(3 * n, n), xs = s.segment(4 * n, n), vs = s.segment(5 * n, n);
    Vector vf(n), f(n), drive(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const AxisRendering& g = c.axes[i].gains;
      const double tau_s = 1.0 / (2.0 * std::numbers::pi * g.velocity_filter_hz);
      const double d = own[static_cast<int>(i)];
      vf[i] = (tau_s * filtered[i] + x[i] - before[i]) / (tau_s + h);
      f[i] = g.k_pm * (xs[i] - x[i]) + g.gamma * d * (vs[i] - vf[i]) - phi * g.k_dm * vf[i];
      drive[i] = (g.k_pm * (x[i] - xs[i]) + d * (vf[i] - vs[i])) / sigma[static_cast<int>(i)];
    }
    Vector next = Vector::Zero(size);
    const Vector acting = delay > 0 ? Vector(s.segment(6 * n, n)) : f;
    if (delay > 0) {
      next.segment(6 * n, (delay - 1) * n) = s.segment(7 * n, (delay - 1) * n);
      next.segment((5 + delay) * n, n) = f;
    }
    Vector all(3 * n);
    all << x, v, acting;
    next.segment(0, 2 * n) = (held * all).head(2 * n);
    next.segment(2 * n, n) = x;
    next.segment(3 * n, n) = vf;
    const Vector push = (Matrix(c.inertias[0]) + t.held_mass) * vs + h * (drive - t.spring * xs);
    next.segment(5 * n, n) = tied * (free * push);
    next.segment(4 * n, n) = xs + h * next.segment(5 * n, n);
    out.col(column) = next;
  }
  return out;
}

Terminations drawTerminations(CoupledDraw& draw, const CoupledCase& c) {
  const int n = static_cast<int>(c.axes.size());
  Terminations t;
  const double inertia = c.inertias[0].diagonal().mean();
  t.mass = draw.semidefinite(n, draw.spread(0.01, 10.0));
  t.damping =
      draw.random() % 2 == 0 ? Matrix::Zero(n, n) : draw.semidefinite(n, draw.spread(0.1, 30.0));
  t.stiffness =
      draw.random() % 3 == 0 ? Matrix::Zero(n, n) : draw.semidefinite(n, draw.spread(1.0, 1e5));
  t.held_mass = draw.random() % 2 == 0 ? Matrix::Zero(n, n)
                                       : draw.semidefinite(n, inertia * draw.spread(0.1, 100.0));
  t.held_damping =
      draw.random() % 2 == 0 ? Matrix::Zero(n, n) : draw.semidefinite(n, draw.spread(0.1, 100.0));
  t.spring =
      draw.random() % 2 == 0 ? Matrix::Zero(n, n) : draw.semidefinite(n, draw.spread(10.0, 1e6));
  const int ties = static_cast<int>(draw.random() % static_cast<unsigned>(n));
  t.ties = Matrix::NullaryExpr(ties, n, [&] { return draw.between(-1.0, 1.0); });
  return t;
}

/// The largest modulus except for drifts: device and avatar moving together where nothing holds
/// them.
double radiusOf(const Matrix& loop) {
  const Eigen::EigenSolver<Matrix> solver(loop, false);
  return solver.eigenvalues().cwiseAbs().maxCoeff();
}

TEST(CoupledPassivity, RandomPersonsObjectsAndGrasps_AreStable) {
  CoupledDraw draw{seededRandom(304)};
  int tried = 0, unstable = 0;
  double largest = 0.0;
  for (int trial = 0; tried < cases(330); ++trial) {  // 10,000 in full
    ASSERT_LT(trial, 3 * cases(330)) << "hardly a case that damping can make passive";
    CoupledCase c = drawCase(draw, 2 + trial % 3);
    const double share = requiredShare(c).share;
    if (!(share < 1e3)) continue;
    for (AxisCase& a : c.axes) a.axis.damping *= 1.002 * std::max(share, 1e-3);
    const Terminations t = drawTerminations(draw, c);
    const AxisRatio truth(static_cast<int>(c.axes.size()), 1.0);
    const double radius = radiusOf(loopWith(c, t, draw.random() % 2 == 0 ? 0.0 : 1.0, truth));
    ++tried;
    unstable += radius > 1.0 + 1e-6 ? 1 : 0;  // a drift is an eigenvalue of 1, often a double one
    largest = std::max(largest, radius);
  }
  figure("coupled persons, objects and grasps tried", tried, "");
  figure("of them unstable", unstable, "");
  figure("largest spectral radius less one", largest - 1.0, "");
  EXPECT_EQ(unstable, 0);
}

/// Thumb and fingers hold a rigid object and the person moves both together, with the shipped
/// gains. The former law rendered the forces 1.6 and 5.7 times as large; the rendered stiffness was
/// negative along one direction and the hand ran away. With one spring nothing grows.
TEST(CoupledPassivity, FistAroundARigidObject_GrewUnderTheFormerLawAndIsStableNow) {
  CoupledCase c;
  c.delay_ticks = 1;
  c.period_s = kPeriod_s;
  for (int i = 0; i < 2; ++i) {
    AxisCase a;
    a.axis.mass = i == 0 ? 5e-4 : 4e-4;  // config/devices/lambda-pride.toml
    a.axis.damping = 0.015;
    a.gains.k_pm = 4.0;
    a.gains.gamma = 0.3;
    a.gains.velocity_filter_hz = 30.0;
    a.inertia = 8e-5;  // armature included
    c.axes.push_back(a);
  }
  c.inertias = {AxisMatrix(8e-5 * AxisMatrix::Identity(2, 2))};
  AxisRatio former(2), truth(2, 1.0);
  former[0] = 1.612, former[1] = 5.743;
  double former_growth = 0.0, growth = 0.0;
  for (int i = 0; i < 180; ++i) {
    if (leftOutUnderASanitizer(static_cast<std::size_t>(i))) continue;
    for (int k = 0; k < 180; k += 3) {
      const auto along = [](int degrees) {
        const double angle = degrees * std::numbers::pi / 180.0;
        return Vector(Eigen::Vector2d(std::cos(angle), std::sin(angle)));
      };
      const Vector grasp = along(i), fist = along(k);
      Terminations t;
      const double tip = 2.5 * 0.08 * 0.08;  // 2.5 N·s/m at the tips
      t.mass = Matrix::Zero(2, 2);
      t.damping = tip * Matrix::Identity(2, 2);
      t.stiffness = 1e3 * fist * fist.transpose();  // a fist: no motion along this direction
      t.held_mass = t.held_damping = t.spring = Matrix::Zero(2, 2);
      t.ties = grasp.transpose();
      const auto rate = [&](const AxisRatio& sigma) {
        return std::log(radiusOf(loopWith(c, t, 0.0, sigma))) / kPeriod_s;
      };
      former_growth = std::max(former_growth, rate(former));
      growth = std::max(growth, rate(truth));
    }
  }
  figure("growth of a fist round a rigid object, former law", former_growth, "1/s");
  figure("and now", growth, "1/s");
  EXPECT_GT(former_growth, 4.0);
  EXPECT_LT(growth, 1e-6);
  EXPECT_LT(requiredShare(c).share, 1.0);
}

}  // namespace
}  // namespace wholehand::test
