// What nothing pushes comes to rest, and its energy only falls: towers of cubes of any masses.
#include "loop/physics/body_yard.hpp"
#include "support/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

using Eigen::Vector3d;

constexpr double kGravity = 9.81, kEdge_m = 0.04;
constexpr double kGives_m = 1e-5;  // SolverSettings::penetration_slop_m

/// A nudged tower: what it did.
struct Course {
  double rests_after_s = 0.0;  ///< last time at which a body was not still
  double risen_j = 0.0;        ///< sum of all rises of its energy
  double sunk_m = 0.0, walked_m = 0.0;
};

double energyOf(const Yard& yard, const std::vector<double>& masses_kg) {
  double sum_j = 0.0;
  for (int k = 1; k <= static_cast<int>(masses_kg.size()); ++k) sum_j += yard.energy(k);
  return sum_j;
}

/// Cubes of 4 cm one on the other, the first below. The top one gets 1 mm/s to a side.
Course nudge(const std::vector<double>& masses_kg, double rate_hz, double aside_rad,
             const Eigen::Matrix3d& turn, double seconds) {
  std::vector<SceneBody> bodies{ground(0.8)};
  const int count = static_cast<int>(masses_kg.size());
  for (int k = 1; k <= count; ++k) {
    bodies.push_back(bodyOf(boxShape(Vector3d::Constant(kEdge_m)), {0.0, 0.0, kEdge_m * (k - 0.5)},
                            masses_kg[k - 1], 0.8));
  }
  Yard yard("bullet", bodies, {0.0, 0.0, -kGravity}, rate_hz, turn, false);
  yard.run(0.5);
  Course course;
  std::vector<Vector3d> from(count + 1);
  for (int k = 1; k <= count; ++k) from[k] = yard.at(k);
  yard.throwBody(count, 1e-3 * Vector3d(std::cos(aside_rad), std::sin(aside_rad), 0.0));
  double energy_j = energyOf(yard, masses_kg);
  for (int i = 0; i < static_cast<int>(std::lround(seconds * rate_hz)); ++i) {
    yard.step();
    const double now_j = energyOf(yard, masses_kg);
    course.risen_j += std::max(0.0, now_j - energy_j);
    energy_j = now_j;
    for (int k = 1; k <= count; ++k) {
      if (yard.velocity(k).norm() < 5e-4 && yard.spin(k).norm() < 0.0125) continue;
      course.rests_after_s = (i + 1) / rate_hz;
    }
  }
  for (int k = 1; k <= count; ++k) {
    const Vector3d moved = yard.at(k) - from[k];
    course.walked_m = std::max(course.walked_m, std::hypot(moved.x(), moved.y()));
    // Each contact gives by kGives_m before it presses.
    const double stands_m = k * (kEdge_m - kGives_m) - 0.5 * kEdge_m;
    course.sunk_m = std::max(course.sunk_m, stands_m - yard.at(k).z());
  }
  return course;
}

/// Masses between a lightest and a hundred times as heavy, in any order; in a third of the draws
/// the heavier the higher.
std::vector<double> anyTower(std::mt19937_64& random) {
  std::vector<double> masses_kg(2 + random() % 11);
  const double lightest_kg = std::exp(uniform(random, std::log(0.002), std::log(0.1)));
  const double ratio = std::exp(uniform(random, 0.0, std::log(100.0)));
  for (double& mass_kg : masses_kg) {
    mass_kg = lightest_kg * std::pow(ratio, uniform(random, 0.0, 1.0));
  }
  if (random() % 3 == 0) std::sort(masses_kg.begin(), masses_kg.end());
  return masses_kg;
}

void expectRest(const std::vector<double>& masses_kg, const Course& course) {
  double mass_kg = 0.0;
  for (const double one : masses_kg) mass_kg += one;
  EXPECT_LE(course.rests_after_s, 2.0);
  // The energy that lifts the tower by 10 µm.
  EXPECT_LE(course.risen_j, mass_kg * kGravity * 1e-5);
  EXPECT_LE(course.sunk_m, 1e-4);
  EXPECT_LE(course.walked_m, 1e-4);
}

TEST(Towers, OfAnyMassesNudged_RestAndOnlyLoseEnergy) {
  auto random = seededRandom(6101);
  const int draws = kReducedCounts ? 3 : fullCounts() ? 500 : 20;
  for (int i = 0; i < draws; ++i) {
    const std::vector<double> masses_kg = anyTower(random);
    const std::array rates{500.0, 1000.0, 2000.0, 4000.0, 8000.0};
    const double rate_hz = rates[random() % (kReducedCounts ? 2 : rates.size())];
    const double aside_rad = uniform(random, 0.0, 2.0 * kPi);
    SCOPED_TRACE(std::to_string(i) + ": " + std::to_string(masses_kg.size()) + " cubes, " +
                 std::to_string(rate_hz) + " Hz");
    const double seconds = fullCounts() ? 4.0 : 2.2;
    expectRest(masses_kg, nudge(masses_kg, rate_hz, aside_rad, anyTurn(random), seconds));
  }
}

TEST(Towers, OfAnyMassesNudged_StandForAMinute_slow) {
  auto random = seededRandom(6102);
  for (int i = 0; i < 20; ++i) {
    const std::vector<double> masses_kg = anyTower(random);
    const double aside_rad = uniform(random, 0.0, 2.0 * kPi);
    SCOPED_TRACE(std::to_string(i) + ": " + std::to_string(masses_kg.size()) + " cubes");
    expectRest(masses_kg, nudge(masses_kg, 1000.0, aside_rad, anyTurn(random), 60.0));
  }
}

/// Masses grow by the same ratio from the lowest cube to the highest. docs/adr/0086 compares them.
TEST(Towers, HeavierUpwards_RestAndOnlyLoseEnergy) {
  struct Tower {
    int cubes;
    double lowest_kg, highest_kg;
  };
  const double tenth_kg = 0.01 * std::pow(1.7, 9);
  for (const Tower& tower : {Tower{4, 0.02, 0.5},
                             {8, 0.02, 2.0},
                             {12, 0.1, 0.1},
                             {10, 0.01, tenth_kg},
                             {8, 1e-3, 1.0}}) {
    std::vector<double> masses_kg;
    double sum_kg = 0.0;
    for (int k = 0; k < tower.cubes; ++k) {
      masses_kg.push_back(tower.lowest_kg *
                          std::pow(tower.highest_kg / tower.lowest_kg, k / (tower.cubes - 1.0)));
      sum_kg += masses_kg.back();
    }
    const std::string name = fmt::format("{} cubes, {:.3g} to {:.3g} kg", tower.cubes,
                                         tower.lowest_kg, tower.highest_kg);
    SCOPED_TRACE(name);
    const Course course = nudge(masses_kg, 1000.0, 0.3, Eigen::Matrix3d::Identity(), 3.0);
    expectRest(masses_kg, course);
    figure("rises of energy, of m g 10 µm: " + name, course.risen_j / (sum_kg * kGravity * 1e-5),
           "");
  }
}

}  // namespace
}  // namespace wholehand::test
