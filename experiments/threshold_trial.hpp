#pragma once

#include "loop/psychometrics/threshold.hpp"

#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace wholehand {

/// A simulated person who compares.
struct VirtualObserver {
  enum class Compares { kX, kOther, kNothing, kFirstAlways };
  Compares compares = Compares::kX;
  Observer observer{};  ///< with kX
  /// The first stimulus is remembered with this share more variance.
  double memory_decay = 0.0;
  double other_noise = 0.3;  ///< kOther: noise, in standard deviations of the other difference

  /// What it says about a comparison.
  [[nodiscard]] bool saysSecond(const Comparison& comparison, std::mt19937_64& random) const;
};

/// Many blocks of one observer.
struct ThresholdTrial {
  int blocks = 0, answers = 0;  ///< answers of each block
  double bias = 0.0, sd = 0.0;  ///< of the fitted σ, as shares of the true one
  double covered = 0.0;         ///< share of 95 % intervals that contain the true σ
  double doubted = 0.0;         ///< share with any doubt
  double guesses = 0.0, one_answer = 0.0, compares_other = 0.0, misses_catches = 0.0;
  double other_right = 0.0;  ///< mean of ThresholdDoubts::other_right
};
[[nodiscard]] ThresholdTrial tryBlocks(const VirtualObserver& observer, int answers, int blocks,
                                       std::uint64_t seed);

}  // namespace wholehand
