#include "loop/psychometrics/difficulty.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// A finding needs this many trials, all of them this near to the bound.
constexpr int kNeeded = 12;
constexpr double kNear = 0.1;
/// Chance of as many successes (or failures) at the aim that is taken for a misfit.
constexpr double kUnlikely = 0.04;

/// P(at least k of n), each with chance p.
double atLeast(int k, int n, double p) noexcept {
  double chance = std::pow(1.0 - p, n), sum = 0.0;
  for (int i = 0; i <= n; ++i) {
    if (i >= k) sum += chance;
    chance *= static_cast<double>(n - i) / (i + 1) * p / (1.0 - p);
  }
  return sum;
}

}  // namespace

double nextDifficulty(double d, bool success, const DifficultyRules& rules) noexcept {
  const double change = success ? rules.step * (1.0 - rules.aim) : -rules.step * rules.aim;
  return std::clamp(d + change, rules.lower, rules.upper);
}

AdaptiveDifficulty::AdaptiveDifficulty(const DifficultyRules& rules, double start) noexcept
    : rules_(rules), d_(std::clamp(start, rules.lower, rules.upper)) {}

void AdaptiveDifficulty::answer(bool success) noexcept {
  trials_[next_] = {d_, success};
  next_ = (next_ + 1) % kShown;
  shown_ = std::min(shown_ + 1, kShown);
  d_ = nextDifficulty(d_, success, rules_);
}

void AdaptiveDifficulty::set(double d) noexcept {
  d_ = std::clamp(d, rules_.lower, rules_.upper);
  shown_ = next_ = 0;
}

int AdaptiveDifficulty::successes() const noexcept {
  int count = 0;
  for (int i = 0; i < shown_; ++i) count += trials_[i].success ? 1 : 0;
  return count;
}

BoundsFinding AdaptiveDifficulty::finding() const noexcept {
  int above = 0, succeeded = 0, below = 0, failed = 0;
  for (int i = 0; i < shown_; ++i) {
    const Trial& trial = trials_[i];
    if (trial.d >= rules_.upper - kNear) ++above, succeeded += trial.success ? 1 : 0;
    if (trial.d <= rules_.lower + kNear) ++below, failed += trial.success ? 0 : 1;
  }
  if (above >= kNeeded && atLeast(succeeded, above, rules_.aim) < kUnlikely) {
    return BoundsFinding::kTooEasy;
  }
  if (below >= kNeeded && atLeast(failed, below, 1.0 - rules_.aim) < kUnlikely) {
    return BoundsFinding::kTooHard;
  }
  return BoundsFinding::kFit;
}

}  // namespace wholehand
