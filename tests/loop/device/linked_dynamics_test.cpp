// Axes that a person links: compared with closed forms and with single axes; only the effort may
// put in energy.
#include "loop/device/simulated/linked_dynamics.hpp"

#include "loop/device/simulated/axis_dynamics.hpp"
#include "loop/realtime/allocation_counter.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

using test::cases;
using test::seededRandom;
using test::tolerance;

constexpr double kStep_s = 1e-3;

struct Draw {
  std::mt19937_64 random;
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1.0p-53;
  }
  double spread(double low, double high) {
    return std::exp(between(std::log(low), std::log(high)));
  }
  bool chance(double share) { return between(0.0, 1.0) < share; }
  int upTo(int most) { return static_cast<int>(random() % static_cast<unsigned>(most + 1)); }
  Eigen::MatrixXd any(int rows, int columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [this] { return between(-1.0, 1.0); });
  }
  AxisMatrix semidefinite(int n, double size) {
    const Eigen::MatrixXd a = any(n, 1 + upTo(n - 1));
    return size * a * a.transpose();
  }
};

/// Axes with mass only, far from their stops.
LinkedPlant freeMasses(int n, double mass) {
  return {mass * AxisMatrix::Identity(n, n),
          AxisMatrix::Zero(n, n),
          AxisMatrix::Zero(n, n),
          AxisEffort(n),
          AxisPosition(n, -1e3),
          AxisPosition(n, 1e3)};
}

LinkedPlant drawPlant(Draw& draw, int n) {
  LinkedPlant plant = freeMasses(n, 0.0);
  const double mass = draw.spread(1e-3, 2.0);
  plant.mass = draw.semidefinite(n, mass * draw.spread(0.1, 10.0));
  for (int i = 0; i < n; ++i) plant.mass(i, i) += mass * draw.spread(0.3, 3.0);
  if (draw.chance(0.7)) plant.damping = draw.semidefinite(n, draw.spread(1e-3, 10.0));
  if (draw.chance(0.7)) plant.stiffness = draw.semidefinite(n, draw.spread(0.1, 1e4));
  for (int i = 0; i < n; ++i) {
    plant.coulomb[i] = draw.chance(0.3) ? 0.0 : draw.between(0.0, 1.0);
    plant.lower[i] = -draw.between(0.01, 0.1);
    plant.upper[i] = draw.between(0.01, 0.1);
  }
  return plant;
}

template <class Array>
Array arrayOf(std::initializer_list<double> values) {
  Array out(static_cast<int>(values.size()));
  std::copy(values.begin(), values.end(), out.data());
  return out;
}

AxisColumn positionsOf(const LinkedDynamics& axes, int n) {
  AxisColumn q(n);
  for (int i = 0; i < n; ++i) q[i] = axes.position(i);
  return q;
}

AxisEffort drawEffort(Draw& draw, int n, double most) {
  AxisEffort f(n);
  for (int i = 0; i < n; ++i) f[i] = draw.between(-most, most);
  return f;
}

/// Removes dry friction and stops: no direction and no moment is special then.
void takeOutEvents(LinkedPlant& plant) {
  const int n = plant.coulomb.size();
  plant.coulomb = AxisEffort(n);
  plant.lower = AxisPosition(n, -1e3);
  plant.upper = AxisPosition(n, 1e3);
}

double energyOf(const LinkedPlant& plant, const LinkedDynamics& axes) {
  const int n = plant.coulomb.size();
  const AxisColumn q = positionsOf(axes, n);
  AxisColumn v(n);
  for (int i = 0; i < n; ++i) v[i] = axes.velocity(i);
  return 0.5 * v.dot(plant.mass * v) + 0.5 * q.dot(plant.stiffness * q);
}

/// Two masses with a spring k between them: the mean position moves uniformly, the distance swings
/// with sqrt(2 k / m), or decays with a damper in parallel.
TEST(LinkedDynamics, TwoMassesOnASpring_SwingInTheirNormalModes) {
  constexpr double kMass = 0.8, kSpring = 300.0, kDamper = 4.0;
  LinkedPlant plant = freeMasses(2, kMass);
  AxisMatrix between(2, 2);
  between << 1.0, -1.0, -1.0, 1.0;
  plant.stiffness = kSpring * between;
  plant.damping = kDamper * between;
  for (const double period_s : {1e-3, 0.25e-3, 5e-3}) {
    LinkedDynamics axes(plant, period_s);
    axes.place(arrayOf<AxisPosition>({0.01, -0.02}), arrayOf<AxisVelocity>({0.3, 0.1}));
    const double sigma = kDamper / kMass;  // (2 d) / (2 m)
    const double omega = std::sqrt(2.0 * kSpring / kMass - sigma * sigma);
    for (int i = 1; i <= 400; ++i) {
      axes.advance(AxisEffort(2), AxisEffort(2));
      const double t_s = i * period_s;
      const double middle = -0.005 + 0.2 * t_s;
      const double apart =
          std::exp(-sigma * t_s) *
          (0.03 * std::cos(omega * t_s) + (0.2 + sigma * 0.03) / omega * std::sin(omega * t_s));
      ASSERT_NEAR(axes.position(0), middle + 0.5 * apart, tolerance(1e-10));
      ASSERT_NEAR(axes.position(1), middle - 0.5 * apart, tolerance(1e-10));
    }
  }
}

/// q̈ = M⁻¹ f for an effort that rises linearly: q = M⁻¹ f' t³ / 6.
TEST(LinkedDynamics, LinkedMassUnderARamp_MovesAsItsInverseSays) {
  LinkedPlant plant = freeMasses(2, 0.0);
  plant.mass << 2.0, 1.0, 1.0, 2.0;  // inverse: 2/3, -1/3
  LinkedDynamics axes(plant, kStep_s);
  for (int i = 0; i < 500; ++i) {
    axes.advance(arrayOf<AxisEffort>({6.0 * i * kStep_s, 0.0}),
                 arrayOf<AxisEffort>({6.0 * (i + 1) * kStep_s, 0.0}));
  }
  EXPECT_NEAR(axes.position(0), 2.0 / 3.0 * 0.125, tolerance(1e-12));
  EXPECT_NEAR(axes.position(1), -1.0 / 3.0 * 0.125, tolerance(1e-12));
  EXPECT_NEAR(axes.velocity(1), -1.0 / 3.0 * 3.0 * 0.25, tolerance(1e-12));
}

/// Diagonal matrices must move as single axes (AxisDynamics, another implementation). Without dry
/// friction and stops they agree to rounding. With friction they agree to what its average over a
/// step of 1/16 ms leaves open. An impact loses what the effort would give in the rest of its step,
/// up to 20 m/s² / 16 kHz = 1.3 mm/s, for the tenths of a second until friction or the next stop
/// removes the difference.
enum class Events { kNone, kFriction, kStops };
class DiagonalMatrices : public ::testing::TestWithParam<std::pair<Events, double>> {};
INSTANTIATE_TEST_SUITE_P(Events, DiagonalMatrices,
                         ::testing::Values(std::pair(Events::kNone, 1e-12),
                                           std::pair(Events::kFriction, 2e-5),
                                           std::pair(Events::kStops, 5e-3)));
TEST_P(DiagonalMatrices, AnyEffort_MovesThemAsSingleAxes) {
  const auto [events, allowed] = GetParam();
  Draw draw{seededRandom(401)};
  double worst = 0.0;
  for (int trial = 0; trial < cases(10); ++trial) {
    LinkedPlant plant = freeMasses(3, 1.0);
    std::vector<AxisDynamics> single;
    for (int i = 0; i < 3; ++i) {
      plant.mass(i, i) = draw.spread(0.3, 2.0);
      plant.damping(i, i) = draw.between(0.0, 10.0);
      plant.stiffness(i, i) = draw.between(0.0, 400.0);
      plant.coulomb[i] = events != Events::kNone ? draw.between(0.0, 0.5) : 0.0;
      if (events == Events::kStops) {
        plant.lower[i] = -0.01, plant.upper[i] = 0.02;
        plant.damping(i, i) += 10.0;
      }
      single.emplace_back(AxisPlant{plant.mass(i, i), plant.damping(i, i), plant.stiffness(i, i),
                                    plant.coulomb[i], plant.lower[i], plant.upper[i]},
                          kStep_s);
      single.back().place(0.002 * i, 0.1);
    }
    LinkedDynamics axes(plant, kStep_s);
    axes.place(arrayOf<AxisPosition>({0.0, 0.002, 0.004}), arrayOf<AxisVelocity>({0.1, 0.1, 0.1}));
    AxisEffort before(3);
    for (int k = 0; k < 1000; ++k) {
      AxisEffort after(3);
      for (int i = 0; i < 3; ++i) after[i] = 6.0 * std::sin(0.01 * (i + 1) * (k + 1));
      axes.advance(before, after);
      for (int i = 0; i < 3; ++i) {
        single[i].advance({before[i], after[i]});
        worst = std::max(worst, std::abs(axes.position(i) - single[i].position()));
      }
      before = after;
    }
  }
  std::printf("figure: linked axes with diagonal matrices against single ones = %.3g m\n", worst);
  EXPECT_LE(worst, tolerance(allowed));
}

/// M' = R M Rᵀ, f' = R f give q' = R q: for every rotation R without dry friction and stops, and
/// with them where R permutes the axes.
TEST(LinkedDynamics, AxesRotatedOrPermuted_MoveTheSame) {
  constexpr int kAxes = 4;
  Draw draw{seededRandom(402)};
  for (int trial = 0; trial < cases(20); ++trial) {
    const bool events = trial % 2 == 1;
    LinkedPlant plant = drawPlant(draw, kAxes);
    if (!events) takeOutEvents(plant);
    AxisMatrix turn = Eigen::HouseholderQR<Eigen::MatrixXd>(draw.any(kAxes, kAxes)).householderQ();
    if (events)
      turn =
          Eigen::PermutationMatrix<4>(Eigen::Vector4i(2, 0, 3, 1)).toDenseMatrix().cast<double>();
    LinkedPlant turned = plant;
    for (auto member : {&LinkedPlant::mass, &LinkedPlant::damping, &LinkedPlant::stiffness}) {
      const AxisMatrix m = turn * plant.*member * turn.transpose();
      turned.*member = 0.5 * (m + m.transpose());
    }
    if (events) {
      turned.coulomb.vec() = turn * plant.coulomb.vec();
      turned.lower.vec() = turn * plant.lower.vec();
      turned.upper.vec() = turn * plant.upper.vec();
    }
    LinkedDynamics axes(plant, kStep_s), others(turned, kStep_s);
    for (int k = 0; k < 200; ++k) {
      const AxisEffort f = drawEffort(draw, kAxes, 2.0 * (events ? 1.0 : plant.mass(0, 0)));
      AxisEffort g(kAxes);
      g.vec() = turn * f.vec();
      axes.advance(f, f);
      others.advance(g, g);
      const AxisColumn expected = turn * positionsOf(axes, kAxes);
      ASSERT_LE((positionsOf(others, kAxes) - expected).cwiseAbs().maxCoeff(),
                tolerance(events ? 1e-9 : 1e-11));
    }
  }
}

/// Kinetic and spring energy grow by at most effort times distance, with sticking, sliding and
/// impacts.
TEST(LinkedDynamics, AnyPassivePersonAndEffort_NeverGainsMoreThanTheWorkDone) {
  Draw draw{seededRandom(404)};
  double smooth = 0.0, worst = 0.0;
  for (int trial = 0; trial < cases(100); ++trial) {
    const int n = 2 + draw.upTo(4);
    LinkedPlant plant = drawPlant(draw, n);
    const bool events = trial % 2 == 1;
    if (!events) takeOutEvents(plant);
    LinkedDynamics axes(plant, draw.chance(0.5) ? 1e-3 : 0.25e-3);
    double most = 1e-6;  // [J] a sticking axis moves by a rounding error of this
    for (int k = 0; k < 100; ++k) {
      const AxisEffort f = drawEffort(draw, n, 3.0);
      const double before = energyOf(plant, axes);
      const AxisColumn q = positionsOf(axes, n);
      axes.advance(f, f);
      double work = 0.0;
      for (int i = 0; i < n; ++i) {
        work += f[i] * (axes.position(i) - q[i]);
        ASSERT_GE(axes.position(i), plant.lower[i]);
        ASSERT_LE(axes.position(i), plant.upper[i]);
      }
      const double after = energyOf(plant, axes);
      most = std::max({most, before, after, std::abs(work)});
      double& created = events ? worst : smooth;
      created = std::max(created, (after - before - work) / most);
    }
  }
  std::printf("figure: energy out of nothing in a period, of the most there was = %.3g\n", smooth);
  std::printf("figure: the same with dry friction and stops = %.3g\n", worst);
  EXPECT_LE(smooth, tolerance(1e-9));  // exact solution: rounding
  // Axes of grams with a newton of friction, in the step in which one starts, stops or sticks.
  EXPECT_LE(worst, tolerance(2e-4));
}

/// M = [2 1; 1 2] at speed (v, 0) meets a stop on the first axis. The impulse p takes v, and the
/// other axis moves on at p M⁻¹₁₀ = v / 2. Setting only the one speed to zero would make energy for
/// (v, w) with w < 0.
TEST(LinkedDynamics, AxisThatHitsAStop_PassesItsImpulseToTheOther) {
  LinkedPlant plant = freeMasses(2, 0.0);
  plant.mass << 2.0, 1.0, 1.0, 2.0;
  plant.upper[0] = 0.001;
  LinkedDynamics axes(plant, kStep_s);
  axes.place(arrayOf<AxisPosition>({0.0005, 0.0}), arrayOf<AxisVelocity>({1.0, 0.0}));
  axes.advance(AxisEffort(2), AxisEffort(2));
  EXPECT_EQ(axes.position(0), 0.001);
  EXPECT_EQ(axes.velocity(0), 0.0);
  EXPECT_NEAR(axes.velocity(1), 0.5, tolerance(1e-12));
  // The first axis is pushed into the stop: no effort reaches the other.
  const auto f = arrayOf<AxisEffort>({3.0, 0.0});
  for (int k = 0; k < 100; ++k) axes.advance(f, f);
  EXPECT_EQ(axes.position(0), 0.001);
  EXPECT_NEAR(axes.velocity(1), 0.5, tolerance(1e-9));
}

/// A spring of 100 N/m links two axes; the second has 0.5 N of dry friction. It stays until the
/// slowly pulled first axis is 5 mm ahead.
TEST(LinkedDynamics, AxisThatSticks_StaysUntilItsLinkPullsHardEnough) {
  LinkedPlant plant = freeMasses(2, 0.5);
  AxisMatrix between(2, 2);
  between << 1.0, -1.0, -1.0, 1.0;
  plant.stiffness = 100.0 * between;
  plant.stiffness(0, 0) += 1000.0;
  plant.damping = 50.0 * AxisMatrix::Identity(2, 2);
  plant.coulomb[1] = 0.5;
  LinkedDynamics axes(plant, kStep_s);
  const auto pull = [&](double force) {
    const auto f = arrayOf<AxisEffort>({force, 0.0});
    for (int k = 0; k < 8000; ++k) axes.advance(f, f);
  };
  pull(0.0049 * 1100.0);  // alone, the axis moves to f / (1000 + 100)
  EXPECT_NEAR(axes.position(0), 0.0049, tolerance(1e-9));
  EXPECT_NEAR(axes.position(1), 0.0, tolerance(1e-9));
  pull(0.02 * 1100.0);  // the second follows to within 5 mm
  EXPECT_NEAR(axes.position(0) - axes.position(1), 0.005, tolerance(1e-5));
}

TEST(LinkedDynamics, Advance_DoesNotAllocate) {
  Draw draw{seededRandom(405)};
  LinkedDynamics axes(drawPlant(draw, 9), kStep_s);
  const AllocationScope count;
  for (int k = 0; k < 200; ++k) axes.advance(AxisEffort(9, k % 3 - 1.0), AxisEffort(9, 0.5));
  EXPECT_EQ(count.allocations(), 0U);
}

/// Every solution satisfies the three conditions that solveBox() states.
TEST(BoxProblem, AnyMatrixAndBounds_SatisfiesItsConditions) {
  Draw draw{seededRandom(406)};
  for (int trial = 0; trial < cases(2000); ++trial) {
    const int n = 1 + draw.upTo(8);
    AxisMatrix g = draw.semidefinite(n, 1.0);
    g.diagonal().array() += draw.spread(1e-3, 1.0);
    AxisColumn w(n), lower(n), upper(n), lambda;
    RangeParts parts{};
    for (int i = 0; i < n; ++i) {
      w[i] = draw.between(-1.0, 1.0);
      lower[i] = draw.chance(0.2) ? -HUGE_VAL : draw.chance(0.2) ? 0.0 : -draw.spread(0.01, 10.0);
      upper[i] = draw.chance(0.2) ? HUGE_VAL : draw.chance(0.2) ? 0.0 : draw.spread(0.01, 10.0);
      parts[i] = static_cast<RangePart>(draw.upTo(2));
    }
    ASSERT_TRUE(solveBox(g, w, lower, upper, parts, lambda));
    const AxisColumn v = w + g * lambda;
    for (int i = 0; i < n; ++i) {
      const double slack = tolerance(1e-9);
      ASSERT_GE(lambda[i], lower[i] - slack);
      ASSERT_LE(lambda[i], upper[i] + slack);
      if (lambda[i] > lower[i] + slack) {
        ASSERT_LE(v[i], slack);
      }
      if (lambda[i] < upper[i] - slack) {
        ASSERT_GE(v[i], -slack);
      }
    }
  }
}

TEST(BoxProblem, IndefiniteMatrix_IsReportedWithoutALoop) {
  AxisMatrix g(2, 2);
  g << 1.0, 2.0, 2.0, 1.0;
  AxisColumn w = AxisColumn::Ones(2), bound = AxisColumn::Constant(2, HUGE_VAL), lambda;
  RangeParts parts{RangePart::kBetween, RangePart::kBetween};
  EXPECT_FALSE(solveBox(g, w, -bound, bound, parts, lambda));
}

}  // namespace
}  // namespace wholehand
