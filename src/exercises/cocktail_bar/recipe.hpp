#pragma once

#include "exercises/cocktail_bar/bar.hpp"
#include "exercises/cocktail_bar/bar_record.hpp"
#include "exercises/cocktail_bar/pouring.hpp"
#include "loop/core/real_time.hpp"
#include "loop/core/tick_record.hpp"

#include <cstdint>

namespace wholehand {

/// Accuracy, 0 .. 1: 1 at the requested amount, 0.8 at the edge of the tolerance, 0 at three
/// tolerances and more.
[[nodiscard]] WHOLEHAND_RT double pourAccuracy(double poured_l, double asked_l,
                                               double tolerance_l) noexcept;

/// Score of a drink, 0 .. 100: (100 − time_points) · accuracy + time_points, minus the cost of
/// spills. The time points are full up to par and zero at twice par and more.
[[nodiscard]] WHOLEHAND_RT double drinkScore(const BarScoring& scoring, double accuracy,
                                             double spilt_l, double time_s, int steps) noexcept;

/// Steps through the drinks of a level and scores them.
class Recipe {
 public:
  explicit Recipe(const Bar& bar) : bar_(bar) {}

  void reset() noexcept;
  /// Resets and begins at the given drink; an invalid number selects the first drink. @pre nothing
  /// was poured yet. Real-time safe.
  WHOLEHAND_RT void beginAt(double drink) noexcept;
  /// Overrides the level's tolerance from now on; the tolerance of a step stays below its amount.
  /// Real-time safe.
  WHOLEHAND_RT void setTolerance(double tolerance_l) noexcept { tolerance_l_ = tolerance_l; }
  /// Ends the pause after a drink. Real-time safe.
  WHOLEHAND_RT void endRest() noexcept { rest_left_s_ = 0.0; }

  /// @param held the held dispenser, -1: none @param pending the target is not in place yet
  WHOLEHAND_RT void tick(double elapsed_s, int held, bool pending, Pouring& pouring,
                         ExerciseRecord& out) noexcept;

  [[nodiscard]] PourOrder order() const noexcept;
  [[nodiscard]] BarStage stage() const noexcept { return stage_; }
  [[nodiscard]] int drink() const noexcept { return drink_; }
  /// The drink to resume with after a rest: this one, or the next if it is done.
  [[nodiscard]] WHOLEHAND_RT int resumeDrink() const noexcept;
  [[nodiscard]] int step() const noexcept { return step_; }
  [[nodiscard]] int steps() const noexcept;
  [[nodiscard]] double score() const noexcept;
  [[nodiscard]] int stars() const noexcept { return stars_; }
  [[nodiscard]] double drinkTime_s() const noexcept { return time_s_; }
  [[nodiscard]] double restLeft_s() const noexcept { return rest_left_s_; }

 private:
  [[nodiscard]] BarStage stageOfStep(int held, bool pending, const Pouring& pouring) const noexcept;
  void endStep(double poured_l, const Pouring& pouring, ExerciseRecord& out) noexcept;
  void endDrink(const Pouring& pouring, ExerciseRecord& out) noexcept;
  void rest(double elapsed_s, Pouring& pouring, ExerciseRecord& out) noexcept;

  const Bar& bar_;
  BarStage stage_ = BarStage::kReach;
  int drink_ = 0, step_ = 0;
  double tolerance_l_ = 0.0;   ///< 0: the level's tolerance applies
  double accuracy_sum_ = 0.0;  ///< sum over this drink's steps
  double spilt_before_l_ = 0.0;
  double time_s_ = 0.0;
  double score_sum_ = 0.0;  ///< sum over completed drinks
  int drinks_done_ = 0;
  int stars_ = 0;
  double rest_left_s_ = 0.0;
};

}  // namespace wholehand
