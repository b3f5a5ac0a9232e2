#include "exercises/cocktail_bar/recipe.hpp"

#include "exercises/cocktail_bar/bar_record.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

double pourAccuracy(double poured_l, double asked_l, double tolerance_l) noexcept {
  const double off = std::abs(poured_l - asked_l) / tolerance_l;
  return off <= 1.0 ? 1.0 - 0.2 * off : std::max(0.0, 0.8 - 0.4 * (off - 1.0));
}

double drinkScore(const BarScoring& scoring, double accuracy, double spilt_l, double time_s,
                  int steps) noexcept {
  const double pars = time_s / (scoring.par_s * steps);
  const double points = (100.0 - scoring.time_points) * accuracy +
                        scoring.time_points * std::clamp(2.0 - pars, 0.0, 1.0) -
                        scoring.spill_points_per_l * spilt_l;
  return std::clamp(points, 0.0, 100.0);
}

void Recipe::reset() noexcept {
  stage_ = BarStage::kReach;
  drink_ = step_ = drinks_done_ = stars_ = 0;
  accuracy_sum_ = spilt_before_l_ = time_s_ = score_sum_ = rest_left_s_ = 0.0;
}

void Recipe::beginAt(double drink) noexcept {
  const auto drinks = static_cast<double>(bar_.drinks.size());
  reset();
  if (drink >= 0.0 && drink < drinks) drink_ = static_cast<int>(drink);
}

int Recipe::resumeDrink() const noexcept {
  if (stage_ == BarStage::kLevelDone) return 0;
  if (stage_ != BarStage::kDrinkDone) return drink_;
  return (drink_ + 1) % static_cast<int>(bar_.drinks.size());
}

int Recipe::steps() const noexcept {
  return static_cast<int>(bar_.drinks[drink_].steps.size());
}

PourOrder Recipe::order() const noexcept {
  const BarStep& s = bar_.drinks[drink_].steps[step_];
  const bool over = stage_ == BarStage::kDrinkDone || stage_ == BarStage::kLevelDone;
  constexpr double kMostShare = 0.9;  // largest tolerance, as a share of the requested amount
  const double tolerance_l =
      tolerance_l_ > 0.0 ? std::min(tolerance_l_, kMostShare * s.amount_l) : s.tolerance_l;
  return {over ? -1 : s.dispenser, step_, s.amount_l, tolerance_l};
}

double Recipe::score() const noexcept {
  return drinks_done_ > 0 ? score_sum_ / drinks_done_ : 0.0;
}

BarStage Recipe::stageOfStep(int held, bool pending, const Pouring& pouring) const noexcept {
  const PourOrder asked = order();
  if (pending) return BarStage::kDrawBack;
  const bool enough = pouring.ledger().layer_l(step_) >= asked.amount_l - asked.tolerance_l;
  if (enough || pouring.empty(asked.dispenser)) return BarStage::kLetGo;
  if (held != asked.dispenser) return BarStage::kReach;
  if (pouring.spent()) return BarStage::kBreathe;
  return pouring.intoGlass() ? BarStage::kPouring : BarStage::kSqueeze;
}

void Recipe::tick(double elapsed_s, int held, bool pending, Pouring& pouring,
                  ExerciseRecord& out) noexcept {
  if (stage_ == BarStage::kLevelDone) return;
  if (stage_ == BarStage::kDrinkDone) {
    rest(elapsed_s, pouring, out);
    return;
  }
  time_s_ += elapsed_s;
  stage_ = stageOfStep(held, pending, pouring);
  const int dispenser = order().dispenser;
  if (stage_ == BarStage::kLetGo && pouring.letGo(dispenser)) {
    endStep(pouring.ledger().layer_l(step_), pouring, out);
  }
}

void Recipe::endStep(double poured_l, const Pouring& pouring, ExerciseRecord& out) noexcept {
  const PourOrder asked = order();
  accuracy_sum_ += pourAccuracy(poured_l, asked.amount_l, asked.tolerance_l);
  addEvent(out, BarEvent::kStepDone, step_, poured_l);
  if (step_ + 1 < steps()) {
    ++step_;
    stage_ = BarStage::kReach;
  } else {
    endDrink(pouring, out);
  }
}

void Recipe::endDrink(const Pouring& pouring, ExerciseRecord& out) noexcept {
  const double spilt_l = pouring.ledger().spilt_l();
  const double points = drinkScore(bar_.scoring, accuracy_sum_ / steps(), spilt_l - spilt_before_l_,
                                   time_s_, steps());
  spilt_before_l_ = spilt_l;
  score_sum_ += points;
  ++drinks_done_;
  stars_ = points >= bar_.scoring.three_stars ? 3 : points >= bar_.scoring.two_stars ? 2 : 1;
  rest_left_s_ = bar_.scoring.rest_s;
  stage_ = BarStage::kDrinkDone;
  addEvent(out, BarEvent::kDrinkDone, drink_, points);
}

void Recipe::rest(double elapsed_s, Pouring& pouring, ExerciseRecord& out) noexcept {
  rest_left_s_ = std::max(0.0, rest_left_s_ - elapsed_s);
  if (rest_left_s_ > 0.0) return;
  if (drink_ + 1 == static_cast<int>(bar_.drinks.size())) {
    stage_ = BarStage::kLevelDone;
    addEvent(out, BarEvent::kLevelDone, -1, score());
    return;
  }
  pouring.newGlass();
  ++drink_;
  step_ = 0;
  accuracy_sum_ = time_s_ = 0.0;
  stage_ = BarStage::kReach;
}

}  // namespace wholehand
