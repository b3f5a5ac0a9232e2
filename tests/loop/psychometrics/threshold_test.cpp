// Placement and threshold. Check values: issue of the project, by Φ alone; the fit: its definition,
// and tests/apps/test_thresholds.py against another implementation.
#include "loop/psychometrics/threshold.hpp"

#include "loop/psychometrics/comparison_block.hpp"
#include "support/seed.hpp"
#include "support/tolerance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace wholehand::test {
namespace {

/// σ of Jones's Weber fraction for viscosity, 19 % at 71 % right.
constexpr double kJones = 0.2223;

std::vector<Comparison> block(const Observer& observer, int answers, std::mt19937_64& random) {
  const LevelScale scale;
  ComparisonBlock block(scale, answers, scale.count - 1, random());
  std::uniform_real_distribution<double> uniform;
  while (!block.over()) block.answer(uniform(random) < observer.saysSecond(block.current().x));
  return {block.answers().begin(), block.answers().end()};
}

TEST(Observer, PublishedWeberFraction_GivesTheSharesOfRightAnswers) {
  EXPECT_NEAR(sigmaOfWeber(0.19, 0.71), kJones, 5e-5);
  const Observer jones{kJones};
  EXPECT_NEAR(jones.right(std::log(1.6)), 0.933, 1e-3);
  EXPECT_NEAR(jones.right(std::log(1.34)), 0.820, 5e-3);
  EXPECT_NEAR(jones.right(std::log(1.10)), 0.619, 1e-3);
  EXPECT_NEAR((Observer{kJones, 0.0, 0.06}.right(10.0)), 0.97, 1e-12) << "1 − λ/2";
}

// 1 down, 3 up: p = 3 (1 − p).
TEST(UpDown, ObserverOfOneShare_SettlesAt75Percent) {
  std::mt19937_64 random(seed());
  std::uniform_real_distribution<double> uniform;
  const LevelScale scale;
  const Observer observer{0.2};
  UpDown method(scale.nearest(0.5), scale.count - 1);
  const int steps = 40'000;
  double right = 0.0;
  for (int i = 0; i < steps; ++i) {
    const bool correct = uniform(random) < observer.right(scale.at(method.level()));
    right += correct ? 1.0 : 0.0;
    method.answer(correct);
  }
  // Nothing drifts: every step down is balanced, whatever was drawn, but for the 24 levels.
  EXPECT_NEAR(right / steps, 0.75, 24.0 / steps);
}

TEST(ComparisonBlock, EveryAnswer_MovesByItsOwnStepAndIsKept) {
  std::mt19937_64 random(seed() + 1);
  const LevelScale scale;
  for (int trial = 0; trial < cases(200); ++trial) {
    const int most = 10 + static_cast<int>(random() % 14);
    ComparisonBlock block(scale, 50, most, random());
    EXPECT_NEAR(std::abs(block.current().x), scale.at(std::min(scale.nearest(0.5), most)), 1e-12)
        << "the first one counts";
    int level = block.level(), catches = 0;
    while (!block.over()) {
      const Comparison now = block.current();
      EXPECT_NEAR(std::abs(now.x), scale.at(block.level()), 1e-12);
      catches += now.is_catch ? 1 : 0;
      if (now.is_catch) EXPECT_EQ(block.level(), most);
      if (!now.is_catch) EXPECT_EQ(block.level(), level) << "a step was changed or lost";
      const bool right = random() % 4 != 0;
      block.answer(right == (now.x > 0.0));
      if (!now.is_catch) level = right ? std::max(level - 1, 0) : std::min(level + 3, most);
    }
    EXPECT_EQ(block.answers().size(), 50U);
    EXPECT_EQ(catches, 5);
    EXPECT_FALSE(block.answers()[0].is_catch);
  }
}

TEST(ComparisonBlock, SameSeed_GivesTheSameBlockAndACopyGoesOnAlike) {
  const LevelScale scale;
  ComparisonBlock a(scale, 80, 23, 5), b(scale, 80, 23, 5), other(scale, 80, 23, 6);
  int different = 0;
  while (!a.over()) {
    const ComparisonBlock copy = a;
    EXPECT_EQ(copy.current().x, b.current().x);
    EXPECT_EQ(copy.current().other, b.current().other);
    different += a.current().other != other.current().other ? 1 : 0;
    a.answer(true), b.answer(true), other.answer(true);
  }
  EXPECT_EQ(different, 80);
}

// The top is a top: no observer beside it is more probable, and the profile has dropped by the
// stated 2.15 at the ends of the interval.
TEST(Threshold, OfAnyBlock_IsTheMostProbableWithItsInterval) {
  std::mt19937_64 random(seed() + 2);
  for (int trial = 0; trial < cases(100); ++trial) {
    const Observer truth{uniform(random, 0.05, 0.6), uniform(random, -0.1, 0.1),
                         uniform(random, 0.0, 0.05)};
    const auto answers = block(truth, 50, random);
    const Threshold fit = fitThreshold(answers);
    const double top = logPosterior(fit.observer, answers);
    for (int i = 0; i < 200; ++i) {
      Observer beside = fit.observer;
      beside.sigma *= std::exp(uniform(random, -1.0, 1.0));
      beside.bias += uniform(random, -0.2, 0.2);
      beside.lapse = uniform(random, 0.0, kMostLapse);
      EXPECT_LE(logPosterior(beside, answers), top + 1e-9);
    }
    EXPECT_LE(fit.low, fit.observer.sigma);
    EXPECT_GE(fit.high, fit.observer.sigma);
    for (const double end : {fit.low, fit.high}) {
      if ((end == fit.low && fit.open_below) || (end == fit.high && fit.open_above)) continue;
      Observer best{end, fit.observer.bias, fit.observer.lapse};
      for (double width = 1.0; width > 1e-5; width *= 0.6) {  // a grid round the best so far
        const Observer middle = best;
        for (int i = -8; i <= 8; ++i) {
          for (int j = -8; j <= 8; ++j) {
            const Observer tried{end, middle.bias + 0.05 * width * i,
                                 std::clamp(middle.lapse + 0.02 * width * j, 0.0, kMostLapse)};
            if (logPosterior(tried, answers) > logPosterior(best, answers)) best = tried;
          }
        }
      }
      EXPECT_NEAR(logPosterior(best, answers), top - 2.15, 1e-5);
    }
  }
}

TEST(Threshold, AnswersThatAreAllRight_OnlyBoundIt) {
  std::vector<Comparison> answers(40);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    answers[i].x = i % 2 == 0 ? 0.02 : -0.02;
    answers[i].said_second = answers[i].x > 0.0;
  }
  const Threshold fit = fitThreshold(answers);
  EXPECT_TRUE(fit.open_below);
  EXPECT_FALSE(fit.open_above);
  EXPECT_LT(fit.high, 0.03);
}

TEST(ThresholdDoubts, PersonsWhoDoNotCompare_AreNamedAndOthersAreNot) {
  std::mt19937_64 random(seed() + 3);
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  const LevelScale scale;
  const int blocks = std::max(5, cases(50));
  int guessers = 0, one_sided = 0, by_position = 0, honest = 0;
  for (int i = 0; i < blocks; ++i) {
    const auto doubts = [&](auto says_second) {
      ComparisonBlock block(scale, 50, scale.count - 1, random());
      while (!block.over()) block.answer(says_second(block.current()));
      return doubtsAbout(block.answers());
    };
    guessers += doubts([&](const Comparison&) { return uniform(random) < 0.5; }).guesses ? 1 : 0;
    one_sided +=
        doubts([&](const Comparison&) { return uniform(random) < 0.02; }).one_answer ? 1 : 0;
    const ThresholdDoubts position =
        doubts([&](const Comparison& c) { return c.other + 0.3 * normal(random) > 0.0; });
    by_position += position.compares_other ? 1 : 0;
    EXPECT_NEAR(position.other_right, 0.5, 0.35);
    const Observer observer{0.05 + 0.01 * static_cast<double>(random() % 55), 0.0, 0.02};
    honest += doubts([&](const Comparison& c) {
                return uniform(random) < observer.saysSecond(c.x);
              }).any()
                  ? 1
                  : 0;
  }
  // `experiment thresholds` measures the shares; here each kind must be seen as a rule.
  EXPECT_GE(guessers, blocks * 6 / 10);
  EXPECT_GE(one_sided, blocks * 6 / 10);
  EXPECT_GE(by_position, blocks * 6 / 10);
  EXPECT_LE(honest, blocks * 3 / 10);
}

}  // namespace
}  // namespace wholehand::test
