// A loop becomes unstable where the certificate says so: every axis is simulated in time on both
// sides of every boundary of the reference's tables. The tables come from an independent program
// (series for the matrix exponential, repeated squaring for the radius).
#include "certify/certificate.hpp"
#include "loop/control/axis_loop.hpp"
#include "loop/control/axis_simulation.hpp"
#include "loop/control/reference_tables.hpp"
#include "support/figure.hpp"
#include "support/seed.hpp"

namespace wholehand::test {
namespace {

/// Stiffness at which the simulated oscillation begins to grow, by bisection within ± 5 % of a
/// guess.
double simulatedStiffness(AxisLoop l, ContactCase contact, double guess, long ticks) {
  double low = 0.95 * guess, high = 1.05 * guess;
  for (int i = 0; i < 6; ++i) {
    const double middle = 0.5 * (low + high);
    l.k_pm = middle;
    (swingsWider({l, contact}, ticks) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

TEST(StabilityFigures, RigidContactTable_SimulatedBoundaryMatchesThePrediction) {
  double worst = 0.0;
  for (const auto& [mass, damping, delay, table] : kRigidContactTable) {
    const AxisLoop l = loopOf(mass, damping, delay, table, 0.0, 30.0);
    const long ticks = std::lround(200e3 * mass / damping);
    const double simulated = simulatedStiffness(l, ContactCase::kRigid, table, ticks);
    EXPECT_NEAR(simulated, table, tolerance(kSide) * table)
        << mass << " " << damping << " " << delay;
    EXPECT_NEAR(simulated, damping / (1e-3 * (0.5 + delay)), 0.025 * table);
    worst = std::max(worst, std::abs(simulated / table - 1.0));
  }
  figure("rigid contact, simulated against predicted, worst", 100.0 * worst, "%");
}

TEST(StabilityFigures, ZWidthTable_SimulatedBoundaryMatchesThePrediction) {
  double worst = 0.0;
  for (const auto& [delay, filter_hz, table] : kDampedContactTable) {
    if (filter_hz != 30.0 && (delay != 1 || filter_hz != 100.0)) continue;
    for (std::size_t i = 0; i < 6; ++i) {
      const AxisLoop l = loopOf(0.5, 1.0, delay, table[i], kDampings[i], filter_hz);
      const double simulated = simulatedStiffness(l, ContactCase::kRigid, table[i], 100000);
      EXPECT_NEAR(simulated, table[i], tolerance(kSide) * table[i]) << delay << " " << filter_hz;
      worst = std::max(worst, std::abs(simulated / table[i] - 1.0));
    }
  }
  figure("Z-width, simulated against predicted, worst", 100.0 * worst, "%");
}

TEST(StabilityFigures, PureDamper_IsUnstableBeyondTheLimit) {
  // Negligible stiffness, m 0.5 kg, b 1: 2 m/T less b without delay, 0.69 m/T with one tick.
  const std::tuple<int, double, double> rows[] = {{0, 1e5, 999.0}, {1, 30.0, 345.0}};
  for (const auto& [delay, filter_hz, limit] : rows) {
    for (const double side : {0.97, 1.03}) {
      AxisSimulation axis(loopOf(0.5, 1.0, delay, 1.0, side * limit, filter_hz),
                          ContactCase::kRigid);
      axis.v = 0.01;
      EXPECT_EQ(swingsWider(axis, 20000), side > 1.0) << delay << " " << side;
    }
  }
}

TEST(StabilityFigures, GraspedObjectTable_SimulatedBoundaryMatchesThePrediction) {
  struct Row {
    double k_ps, held, gamma, table;
  };
  const Row rows[] = {{900, 0, 0, 17496},   {900, 5, 0, 4841},     {900, 20, 0, 2014},
                      {10000, 0, 0, 42063}, {10000, 5, 0, 11390},  {10000, 20, 0, 4526},
                      {2500, 20, 0, 2806},  {2500, 20, 0.5, 17030}};
  double worst = 0.0;
  for (const Row& row : rows) {
    AxisLoop l = loopOf(0.8, 1.0, 1, row.table, 0.0, 30.0, row.k_ps, row.gamma);
    l.held_mass = row.held;
    const double simulated = simulatedStiffness(l, ContactCase::kObject, row.table, 100000);
    EXPECT_NEAR(simulated, row.table, tolerance(kSide) * row.table)
        << row.k_ps << " μ " << row.held << " γ " << row.gamma;
    worst = std::max(worst, std::abs(simulated / row.table - 1.0));
  }
  figure("grasped object, simulated against predicted, worst", 100.0 * worst, "%");
}

/// The radius as the rate at which the simulated energy decays or grows, long after the start.
double simulatedRadius(const AxisLoop& l, ContactCase contact) {
  AxisSimulation axis(l, contact);
  axis.start(1e-3, 0.01);
  constexpr long kSettle = 8000, kMeasure = 24000;
  // The root of the energy fluctuates with the oscillation, so the mean logarithms of both halves
  // are compared.
  double first = 0.0, second = 0.0;
  for (long k = 0; k < kSettle + kMeasure; ++k) {
    axis.tick();
    if (k < kSettle) continue;
    (k < kSettle + kMeasure / 2 ? first : second) += 0.5 * std::log(axis.energy());
  }
  return std::exp((second - first) / (0.5 * kMeasure) / (0.5 * kMeasure));
}

TEST(StabilityFigures, SpectralRadii_AreTheSimulatedRatesOfDecayOrGrowth) {
  struct Row {
    bool arm;
    ContactCase contact;
    double phi_k_dm, table;
  };
  // m 0.8, b 1, K_pm 1000, K_ps 2500, 30 Hz, n 1; relaxed arm 1 kg, 5 N·s/m, 100 N/m.
  const Row rows[] = {
      {false, ContactCase::kRigid, 0, 1.000312}, {false, ContactCase::kRigid, 10, 0.993900},
      {true, ContactCase::kRigid, 0, 0.998752},  {true, ContactCase::kRigid, 10, 0.995891},
      {true, ContactCase::kFree, 0, 0.998550},   {true, ContactCase::kFree, 10, 0.996572}};
  for (const Row& row : rows) {
    AxisLoop l = loopOf(0.8, 1.0, 1, 1000.0, row.phi_k_dm, 30.0);
    if (row.arm) l.person = {1.0, 5.0, 100.0};
    const double predicted = spectralRadius(closedLoopMatrix(l, row.contact));
    EXPECT_NEAR(predicted, row.table, 1e-6);
    EXPECT_NEAR(simulatedRadius(l, row.contact), row.table,
                tolerance(kSide) * std::abs(1.0 - row.table) + 5e-7)
        << row.arm << " " << row.phi_k_dm;
  }
}

/// Gains outside the certificate whose loop has unstable eigenvalues do oscillate with the
/// predicted growth.
TEST(StabilityFigures, GainsPredictedUnstable_GrowInTheSimulation) {
  auto rng = seededRandom(61);
  std::uniform_real_distribution<double> u(0.0, 1.0);
  const auto between = [&](double low, double high) { return low * std::pow(high / low, u(rng)); };
  int unstable = 0;
  const int wanted = cases(350);
  for (int trial = 0; trial < 200 * wanted && unstable < wanted; ++trial) {
    AxisLoop l = loopOf(between(0.05, 5.0), between(0.05, 5.0), static_cast<int>(4.0 * u(rng)),
                        between(300.0, 60000.0), u(rng) < 0.3 ? 0.0 : between(0.1, 60.0), 30.0,
                        between(400.0, 4e4), u(rng));
    if (u(rng) < 0.5) l.person = {between(0.05, 5.0), between(0.1, 20.0), between(10.0, 2000.0)};
    const ContactCase contact =
        std::array{ContactCase::kFree, ContactCase::kRigid,
                   ContactCase::kObject}[static_cast<std::size_t>(3.0 * u(rng))];
    l.held_mass = between(0.1, 20.0);
    l.spring_per_s2 = u(rng) < 0.5 ? 0.0 : between(10.0, 1e5);
    const double excess = spectralRadius(closedLoopMatrix(l, contact)) - 1.0;
    if (!(excess > 1e-4)) continue;
    ++unstable;
    AxisSimulation axis(l, contact);
    axis.start(1e-3, 0.01);
    // Growth is hardly visible in the beginning; e^40 is beyond doubt.
    const long ticks = std::lround(40.0 / std::log1p(excess));
    const double begun = axis.energy();
    for (long k = 0; k < ticks && axis.energy() < 1e30; ++k) axis.tick();
    EXPECT_GT(axis.energy(), 1e6 * begun) << "trial " << trial << ", radius " << 1.0 + excess;
  }
  EXPECT_EQ(unstable, wanted);
  figure("gains predicted unstable that grew", unstable, "sets");
}

}  // namespace
}  // namespace wholehand::test
