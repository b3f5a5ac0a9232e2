// A number on a grid is packed as its distance in steps; whatever else comes back to the bit, too.
#include "telemetry/grid_steps.hpp"

#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace wholehand::recording {
namespace {

std::uint64_t bits(double value) {
  return std::bit_cast<std::uint64_t>(value);
}
void expectBack(std::uint64_t number, double expected, double step) {
  const GridSteps grid(bits(expected), step);
  ASSERT_EQ(grid.unpack(grid.pack(number)), number)
      << std::hex << number << " from " << expected << " in steps of " << step;
}

constexpr std::array kSteps = {1e-5, 1e-4, 0x1p-20, 0x1p-24, 1.0, 3.7, 0.0, -1e-5, 1e-300, 1e300};

TEST(GridSteps, NumbersOnTheGrid_AreCountedInSteps) {
  for (const double step : {1e-5, 0x1p-24, 3.7}) {
    const GridSteps grid(bits(1000.4 * step), step);
    EXPECT_EQ(grid.pack(bits(1000.0 * step)), 0U);
    EXPECT_EQ(grid.pack(bits(999.0 * step)), 1U);
    EXPECT_EQ(grid.pack(bits(1001.0 * step)), 2U);
    EXPECT_EQ(grid.pack(bits(0.0)), 1999U);
    EXPECT_EQ(grid.pack(bits(-1000.0 * step)), 3999U);
    EXPECT_GT(grid.pack(bits(-0.0)), 0xFFFF'FFFFU);  // no point of the grid
  }
}

TEST(GridSteps, AnyBitsFromAnyExpectation_ComeBack) {
  auto random = test::seededRandom(71);
  const int count = test::cases(2000);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const double step : kSteps) {
    for (const double expected : {0.0, -0.0, 1.0, -0.3, 5e-324, 1e300, kInfinity, -kInfinity}) {
      for (const double number : {0.0, -0.0, 5e-324, 1.0, kInfinity, expected, expected + step}) {
        expectBack(bits(number), expected, step);
      }
      for (int i = 0; i < count; ++i) expectBack(random(), expected, step);
      // Few bits away: their codes are among those that count steps.
      for (int i = 0; i < count; ++i) {
        expectBack(bits(expected) + random() % 5'000'000'000ULL, expected, step);
        expectBack(bits(expected) - random() % 2000, expected, step);
      }
    }
  }
}

// A code that counts steps stands for a grid point; that point's own difference of bits may be
// small itself, and so on. With a step of few bits, such chains are long.
TEST(GridSteps, NumbersBesideAFineGrid_ComeBack) {
  auto random = test::seededRandom(72);
  for (const double step : {std::ldexp(1.0, -50), std::ldexp(1.0, -49), std::ldexp(3.0, -50)}) {
    for (int i = 0; i < test::cases(100'000); ++i) {
      const double expected = std::ldexp(static_cast<double>(random() % 4096), -12);
      expectBack(bits(expected) + random() % 64 - 32, expected, step);
    }
  }
}

}  // namespace
}  // namespace wholehand::recording
