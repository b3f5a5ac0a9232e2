// Arithmetic of solver rows: the sums as they are defined, and the same bits on every processor.
#include "physics/bullet/row_arithmetic.hpp"

#include "core/vector_clones.hpp"
#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace wholehand::bullet {
namespace {

constexpr int kAxes = 8;

/// A row, and what it moves; random numbers of many sizes.
struct Numbers {
  std::array<double, kAxes> jacobian{}, change{};
  std::array<double, 4> linear{}, linear_velocity{}, angular{}, angular_velocity{};

  explicit Numbers(std::mt19937_64& random) {
    std::normal_distribution<double> mantissa;
    std::uniform_int_distribution<int> exponent(-20, 20);
    const auto fill = [&](auto& numbers) {
      for (double& n : numbers) n = std::ldexp(mantissa(random), exponent(random));
    };
    fill(jacobian), fill(change);
    fill(linear), fill(linear_velocity), fill(angular), fill(angular_velocity);
  }
};

// The definition, one product at a time in the order that the header states.
double byDefinition(const Numbers& n) {
  std::array<double, 4> sum{};
  for (std::size_t i = 0; i < 4; ++i) {
    const volatile double along = n.linear[i] * n.linear_velocity[i];  // volatile: never fused
    const volatile double about = n.angular[i] * n.angular_velocity[i];
    sum[i] = along + about;
  }
  for (std::size_t a = 0; a < kAxes; ++a) {
    const volatile double product = n.jacobian[a] * n.change[a];
    sum[a % 4] += product;
  }
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

// As the solver calls it: compiled for AVX and for any processor.
WHOLEHAND_VECTOR_CLONES double onThisProcessor(const Numbers& n) {
  return alongRow<kAxes>(n.jacobian.data(), n.change.data(), n.linear.data(),
                         n.linear_velocity.data(), n.angular.data(), n.angular_velocity.data());
}

double onAnyProcessor(const Numbers& n) {
  return alongRow<kAxes>(n.jacobian.data(), n.change.data(), n.linear.data(),
                         n.linear_velocity.data(), n.angular.data(), n.angular_velocity.data());
}

WHOLEHAND_VECTOR_CLONES void addOnThisProcessor(Numbers& n, double factor) {
  addScaled<kAxes>(n.change.data(), factor, n.jacobian.data());
}

void addOnAnyProcessor(Numbers& n, double factor) {
  addScaled<kAxes>(n.change.data(), factor, n.jacobian.data());
}

TEST(RowArithmetic, EveryProcessor_GivesTheBitsOfTheDefinition) {
  auto random = test::seededRandom(1203);
  for (int i = 0; i < 10'000; ++i) {
    const Numbers n(random);
    const double expected = byDefinition(n);
    ASSERT_EQ(onThisProcessor(n), expected) << "numbers " << i;
    ASSERT_EQ(onAnyProcessor(n), expected) << "numbers " << i;
  }
}

TEST(RowArithmetic, AScaledRow_IsAddedNumberByNumber) {
  auto random = test::seededRandom(1204);
  for (int i = 0; i < 10'000; ++i) {
    const Numbers before(random);
    Numbers here = before, anywhere = before;
    const double factor = before.linear[0];
    addOnThisProcessor(here, factor);
    addOnAnyProcessor(anywhere, factor);
    for (std::size_t a = 0; a < kAxes; ++a) {
      const volatile double product = factor * before.jacobian[a];
      ASSERT_EQ(here.change[a], before.change[a] + product) << "numbers " << i;
      ASSERT_EQ(anywhere.change[a], here.change[a]) << "numbers " << i;
    }
  }
}

}  // namespace
}  // namespace wholehand::bullet
