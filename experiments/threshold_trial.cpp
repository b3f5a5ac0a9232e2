#include "experiments/threshold_trial.hpp"

#include "loop/psychometrics/comparison_block.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {

bool VirtualObserver::saysSecond(const Comparison& comparison, std::mt19937_64& random) const {
  std::uniform_real_distribution<double> uniform;
  std::normal_distribution<double> normal;
  switch (compares) {
    case Compares::kNothing:
      return uniform(random) < 0.5;
    case Compares::kFirstAlways:
      return uniform(random) < 0.02;
    case Compares::kOther:
      return comparison.other + other_noise * normal(random) > 0.0;
    case Compares::kX:
      break;
  }
  if (uniform(random) < observer.lapse) return uniform(random) < 0.5;
  const double first = observer.sigma * std::sqrt(1.0 + memory_decay) * normal(random);
  const double second = observer.sigma * normal(random);
  return comparison.x + observer.bias + second - first > 0.0;
}

ThresholdTrial tryBlocks(const VirtualObserver& observer, int answers, int blocks,
                         std::uint64_t seed) {
  const LevelScale scale;
  // Half the memory's variance counts for each stimulus: what the fit can find.
  const double sigma = observer.observer.sigma * std::sqrt(1.0 + 0.5 * observer.memory_decay);
  std::mt19937_64 random(seed);
  ThresholdTrial out{blocks, answers};
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < blocks; ++i) {
    ComparisonBlock block(scale, answers, scale.count - 1, random());
    while (!block.over()) block.answer(observer.saysSecond(block.current(), random));
    const ThresholdDoubts doubts = doubtsAbout(block.answers());
    out.doubted += doubts.any() ? 1.0 : 0.0;
    out.guesses += doubts.guesses ? 1.0 : 0.0;
    out.one_answer += doubts.one_answer ? 1.0 : 0.0;
    out.compares_other += doubts.compares_other ? 1.0 : 0.0;
    out.misses_catches += doubts.misses_catches ? 1.0 : 0.0;
    out.other_right += doubts.other_right;
    if (observer.compares != VirtualObserver::Compares::kX) continue;
    const Threshold fit = fitThreshold(block.answers());
    const double share = fit.observer.sigma / sigma;
    sum += share;
    squares += share * share;
    out.covered += fit.low <= sigma && sigma <= fit.high ? 1.0 : 0.0;
  }
  const double n = blocks, mean = sum / n;
  out.bias = mean - 1.0;
  out.sd = std::sqrt(std::max(0.0, squares / n - mean * mean));
  for (double* share : {&out.covered, &out.doubted, &out.guesses, &out.one_answer,
                        &out.compares_other, &out.misses_catches, &out.other_right}) {
    *share /= n;
  }
  return out;
}

}  // namespace wholehand
