// The paper's Fig. 7: phases detected in the data, and the effort rendered in them.
#include "experiments/exercise_trial.hpp"

#include "experiments/exercise_script.hpp"
#include "support/contains.hpp"
#include "support/rig_tools.hpp"
#include "support/seed.hpp"

#include <cmath>

namespace wholehand::test {
namespace {

namespace at = exercise_times;

const ExerciseResult& playedByScript() {
  static const ExerciseResult result = [] {
    ExercisePlan plan;
    plan.files = exerciseFiles("cocktail-bar");
    return orThrow(runExercise(plan));
  }();
  return result;
}

TEST(Exercise, Phases_AreInOrderAndWithinTheScriptsTimes) {
  const ExerciseResult& r = playedByScript();
  ASSERT_EQ(r.phases.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT(r.phases[i].start_s, r.phases[i].end_s) << r.phases[i].name;
    if (i > 0) {
      EXPECT_LE(r.phases[i - 1].end_s, r.phases[i].start_s) << r.phases[i].name;
    }
  }
  const auto within = [](double t, double from, double to) { return t > from && t < to; };
  EXPECT_TRUE(within(r.phases[0].start_s, at::kBeside, at::kHardBump)) << r.phases[0].start_s;
  EXPECT_TRUE(within(r.phases[0].end_s, at::kSoftBump, at::kBumped)) << r.phases[0].end_s;
  EXPECT_TRUE(within(r.phases[1].start_s, at::kAligned, at::kEntered)) << r.phases[1].start_s;
  EXPECT_TRUE(within(r.phases[2].start_s, at::kCloses, at::kSqueezes)) << r.phases[2].start_s;
  EXPECT_TRUE(within(r.phases[2].end_s, at::kLetsGo, at::kOpened)) << r.phases[2].end_s;
  EXPECT_TRUE(within(r.phases[3].end_s, at::kOff, at::kAway + 0.2)) << r.phases[3].end_s;
  ASSERT_EQ(r.bumps.size(), 2U);
  EXPECT_GT(r.bumps[0].contact_n, r.bumps[1].contact_n);  // the script makes the first bump harder
}

TEST(Exercise, CompletedExercise_ServesTheDrinkWithoutLoss) {
  const ExerciseResult& r = playedByScript();
  EXPECT_TRUE(r.completed);
  EXPECT_FALSE(r.faulted);
  EXPECT_NEAR(r.poured_l, r.asked_l, r.tolerance_l);
  EXPECT_EQ(r.spilt_l, 0.0);
  figure("volume error", r.volume_error_l, "l");
  EXPECT_LE(r.volume_error_l, tolerance(1e-9));  // the requirement for pouring
}

/// Algorithm 1: the bump raises φ to 1, then φ decays as e^{-t/τ} (τ = decay_s of the gains).
TEST(Exercise, HardBump_RaisesPhiToOneWhichThenDecaysExponentially) {
  const ExerciseResult& r = playedByScript();
  ASSERT_FALSE(r.phases.empty());
  const int fingers = 3;
  ASSERT_EQ(r.axis_names[fingers], "finger_flexion");
  double peak = 0.0, peak_at_s = 0.0;
  for (const ExerciseSample& s : r.samples) {
    if (s.phi[fingers] > peak) {
      peak = s.phi[fingers];
      peak_at_s = s.time_s;
    }
  }
  EXPECT_EQ(peak, 1.0);
  EXPECT_EQ(peak, r.phi_peak[fingers]);
  EXPECT_GE(peak_at_s, r.phases[0].start_s);
  EXPECT_LE(peak_at_s, r.phases[0].end_s);
  const double tau_s = 0.3;  // config/rendering/lambda-pride.toml
  EXPECT_NEAR(r.fading_s[fingers], tau_s, 1e-6);
  // Checks every tick between the bumps; the arm's axes follow the largest φ (Eq. 5).
  const ExerciseSample* before = nullptr;
  for (const ExerciseSample& s : r.samples) {
    if (s.time_s < r.bumps[0].end_s + 0.3 || s.time_s > r.bumps[1].start_s - 0.5) continue;
    if (before != nullptr) {
      ASSERT_NEAR(s.phi[fingers], before->phi[fingers] * std::exp(-1e-3 / tau_s), 1e-12);
      ASSERT_EQ(s.phi[0], s.phi[fingers]);
    }
    before = &s;
  }
  ASSERT_NE(before, nullptr);
}

TEST(Exercise, Wall_NeverPullsAndFadesInAndOutCompletely) {
  const ExerciseResult& r = playedByScript();
  EXPECT_EQ(r.wall_pull_max_n, 0.0);  // Eq. (15), its sign corrected
  EXPECT_GT(r.wall_push_max_n, 0.3);  // the wall acts
  EXPECT_EQ(r.alpha_max, 1.0);
  EXPECT_EQ(r.samples.back().alpha, 0.0);
  // T_on and T_off of config/exercises/cocktail-bar.toml, 1 s and 0.3 s as in the paper.
  double rise_s = 0.0, fall_s = 0.0;
  for (std::size_t i = 1; i < r.samples.size(); ++i) {
    const double d = r.samples[i].alpha - r.samples[i - 1].alpha;
    rise_s += d > 0.0 ? 1e-3 : 0.0;
    fall_s += d < 0.0 ? 1e-3 : 0.0;
  }
  EXPECT_NEAR(rise_s, 1.0, 0.0021);
  EXPECT_NEAR(fall_s, 0.3, 0.0021);
}

TEST(Exercise, RandomSeeds_AreCompleted) {
  auto random = seededRandom(71);
  for (int i = 0; i < cases(2); ++i) {
    ExercisePlan plan;
    plan.files = exerciseFiles("cocktail-bar");
    plan.seed = random() % 1'000'000;
    const ExerciseResult r = orThrow(runExercise(plan));
    EXPECT_TRUE(r.completed) << "seed " << plan.seed << ", poured " << r.poured_l;
  }
}

TEST(Exercise, SceneWithoutDispensersOrFingers_IsRefused) {
  ExercisePlan plan;
  plan.files = exerciseFiles("free-grasping");
  const auto none = runExercise(plan);
  EXPECT_TRUE(refusedWith(none, "no dispenser"));
}

/// Phases of a synthetic trace whose boundaries are known.
TEST(ExercisePhases, SyntheticTrace_HasItsKnownBoundaries) {
  std::vector<ExerciseSample> samples;
  const auto in = [](double t, double from, double to) { return t >= from && t < to; };
  for (int k = 0; k < 10000; ++k) {
    ExerciseSample s;
    s.time_s = k * 1e-3;
    const double t = s.time_s;
    s.phi = AxisRatio(1);
    s.dorsal_n = s.fingers_n = in(t, 1.0, 1.2) || in(t, 1.8, 2.0) ? 3.0 : 0.0;
    if (in(t, 5.0, 8.0)) s.fingers_n = 6.0;
    s.palm_m = in(t, 3.0, 9.0) ? 0.01 : 0.2;
    s.alpha = in(t, 4.0, 9.5) ? 0.5 : 0.0;
    s.flow_l_s = in(t, 6.0, 7.5) ? 0.01 : 0.0;
    samples.push_back(s);
  }
  const auto phases = findPhases(samples);
  ASSERT_TRUE(phases.has_value());
  const double expected[4][2] = {{1.0, 1.999}, {2.999, 5.0}, {5.0, 7.499}, {7.499, 9.499}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR((*phases)[i].start_s, expected[i][0], 1.5e-3) << i;
    EXPECT_NEAR((*phases)[i].end_s, expected[i][1], 1.5e-3) << i;
  }
  EXPECT_EQ(findBumps(samples, phases->front()).size(), 2U);
  for (ExerciseSample& s : samples) s.flow_l_s = 0.0;
  EXPECT_FALSE(findPhases(samples).has_value());  // without a squeeze there are no phases
}

}  // namespace
}  // namespace wholehand::test
