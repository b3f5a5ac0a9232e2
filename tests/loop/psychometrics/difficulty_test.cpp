// Checks adaptive difficulty with drawn patients whose ability drifts.
#include "loop/psychometrics/difficulty.hpp"

#include "support/seed.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace wholehand::test {
namespace {

/// A patient who succeeds at d with a logistic chance: 70 % at d70, less above.
struct DriftingPatient {
  double d70, slope, drift;  ///< slope of the chance's logit, change of d70 a trial

  [[nodiscard]] double chance(double d) const {
    return 1.0 / (1.0 + std::exp(slope * (d - d70) - std::log(0.7 / 0.3)));
  }
};

TEST(Difficulty, Answers_MoveItByTheLaw) {
  const DifficultyRules rules{0.7, 0.06, 0.2, 0.9};
  EXPECT_NEAR(nextDifficulty(0.5, true, rules), 0.518, 1e-15);   // 0.5 + 0.06 · 0.3
  EXPECT_NEAR(nextDifficulty(0.5, false, rules), 0.458, 1e-15);  // 0.5 − 0.06 · 0.7
  EXPECT_EQ(nextDifficulty(0.89, true, rules), 0.9);
  EXPECT_EQ(nextDifficulty(0.21, false, rules), 0.2);
  AdaptiveDifficulty at(rules, 0.5);
  for (int i = 0; i < 25; ++i) at.answer(i % 4 != 0);
  EXPECT_EQ(at.shown(), 20);
  EXPECT_EQ(at.successes(), 15);
  at.set(0.3);  // what a therapist sets wins
  EXPECT_EQ(at.value(), 0.3);
  EXPECT_EQ(at.shown(), 0);
}

/// Of the trials 51 to 200 of 100 patients, nine in ten lie within 0.1 of d70; its share of
/// successes is the aim.
TEST(Difficulty, PatientsWhoDrift_AreFollowed) {
  auto random = seededRandom(6607);
  int within = 0, trials = 0, successes = 0;
  for (int i = 0; i < 100; ++i) {
    DriftingPatient patient{uniform(random, 0.3, 0.7), uniform(random, 10.0, 25.0),
                            uniform(random, -0.002, 0.002)};
    AdaptiveDifficulty at(DifficultyRules{}, 0.5);
    for (int trial = 1; trial <= 200; ++trial) {
      const bool success = uniform(random, 0.0, 1.0) < patient.chance(at.value());
      if (trial > 50) {
        ++trials;
        within += std::abs(at.value() - patient.d70) <= 0.1 ? 1 : 0;
        successes += success ? 1 : 0;
      }
      at.answer(success);
      patient.d70 = std::clamp(patient.d70 + patient.drift, 0.1, 0.9);
    }
  }
  const double share = static_cast<double>(within) / trials;
  std::printf("figure: difficulty within 0.1 of d70 in %.1f %% of trials, success %.1f %%\n",
              100.0 * share, 100.0 * successes / trials);
  EXPECT_GE(share, 0.9);
  EXPECT_NEAR(static_cast<double>(successes) / trials, 0.7, 0.02);
}

/// d70 beyond the bounds by a fifth of the scale is said within 20 trials, in 95 of 100 patients;
/// a patient within the bounds is accused in at most 3 of 100 blocks of 100 trials.
TEST(Difficulty, BoundsThatDoNotFit_AreSaidWithin20Trials) {
  auto random = seededRandom(6608);
  const DifficultyRules rules{0.7, 0.06, 0.3, 0.7};
  int said = 0, wrong = 0;
  const int patients = 200;
  for (int i = 0; i < patients; ++i) {
    const bool easy = i % 2 == 0;
    const DriftingPatient beyond{easy ? 0.9 : 0.1, uniform(random, 10.0, 25.0), 0.0};
    AdaptiveDifficulty at(rules, easy ? 0.7 : 0.3);
    for (int trial = 0; trial < 20; ++trial) {
      at.answer(uniform(random, 0.0, 1.0) < beyond.chance(at.value()));
    }
    said += at.finding() == (easy ? BoundsFinding::kTooEasy : BoundsFinding::kTooHard) ? 1 : 0;
    const DriftingPatient fits{uniform(random, 0.4, 0.6), uniform(random, 10.0, 25.0), 0.0};
    AdaptiveDifficulty within(rules, 0.5);
    bool accused = false;
    for (int trial = 0; trial < 100; ++trial) {
      within.answer(uniform(random, 0.0, 1.0) < fits.chance(within.value()));
      accused = accused || within.finding() != BoundsFinding::kFit;
    }
    wrong += accused ? 1 : 0;
  }
  std::printf("figure: bounds that do not fit are said in %d of %d, fitting ones in %d\n", said,
              patients, wrong);
  EXPECT_GE(said, patients * 95 / 100);
  EXPECT_LE(wrong, patients * 3 / 100);
}

}  // namespace
}  // namespace wholehand::test
