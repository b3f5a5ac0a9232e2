#pragma once

#include "loop/psychometrics/comparison.hpp"

#include <span>

namespace wholehand {

/// A person who compares: with noise of standard deviation σ on each of the two stimuli (in ln), a
/// bias towards the second, and lapses, answers by chance.
struct Observer {
  double sigma = 0.2;
  double bias = 0.0;   ///< in x; > 0: tends to say "the second"
  double lapse = 0.0;  ///< λ, 0 .. kMostLapse

  /// P(says "the second") = λ/2 + (1 − λ) Φ((x + bias) / √2 σ)
  [[nodiscard]] double saysSecond(double x) const noexcept;
  /// P(right) at ±x, over both orders: (1 − λ) Φ(x / √2 σ) + λ/2 without a bias.
  [[nodiscard]] double right(double x) const noexcept;
};
inline constexpr double kMostLapse = 0.06;

/// σ that belongs to a published Weber fraction at a share of right answers: ln(1 + W) / (√2 z(P)).
[[nodiscard]] double sigmaOfWeber(double fraction, double right) noexcept;

/// Natural logarithm of the likelihood of all answers. Not real-time safe, as all below.
[[nodiscard]] double logLikelihood(const Observer& observer, std::span<const Comparison> answers);
/// The same plus that of the prior: ln σ is normal about ln 0.2 with a standard deviation of 2, the
/// bias about 0 with 0.5.
[[nodiscard]] double logPosterior(const Observer& observer, std::span<const Comparison> answers);

/// The threshold of a block of comparisons.
struct Threshold {
  Observer observer;             ///< most probable one
  double low = 0.0, high = 0.0;  ///< 95 % interval of σ, by profile likelihood
  /// The interval reaches the end of what is searched: σ is only known to be below high, or above
  /// low.
  bool open_below = false, open_above = false;
};

/// Fits σ, bias and λ to all answers, never to reversals alone: means of reversals are biased by
/// +16 %. @pre at least one answer
[[nodiscard]] Threshold fitThreshold(std::span<const Comparison> answers);

/// What stands against a threshold. Each is a ratio of likelihoods between the observer above and
/// one that does not compare.
struct ThresholdDoubts {
  bool guesses = false;         ///< answers do not depend on x
  bool one_answer = false;      ///< nearly always the same answer
  bool compares_other = false;  ///< the other difference explains the answers better
  bool misses_catches = false;  ///< wrong where everybody is right
  /// Share of right answers of a person who compares the other difference only.
  double other_right = 0.5;

  [[nodiscard]] bool any() const noexcept {
    return guesses || one_answer || compares_other || misses_catches;
  }
};
[[nodiscard]] ThresholdDoubts doubtsAbout(std::span<const Comparison> answers);

/// Number of answers below which no threshold is stated.
inline constexpr int kLeastAnswers = 30;

/// second / first of which a person with this σ tells three of four: e^(√2 σ z(3/4)).
[[nodiscard]] double ratioAtThreeOfFour(double sigma) noexcept;

/// A threshold is stated up to a σ of the largest difference over this.
inline constexpr double kSigmasInRange = 1.8;

/// Range of |x| that was offered.
struct OfferedRange {
  double least = 0.0, most = 0.0;
};

/// What a block says of a threshold: the threshold, or what is missing.
struct ThresholdFinding {
  Threshold threshold;  ///< without a meaning where there is no answer
  ThresholdDoubts doubts;
  int missing = 0;               ///< number of answers that are missing
  bool beyond_range = false;     ///< σ > most / 1.8: the differences were too small for it
  bool at_device_limit = false;  ///< three of four right needs less than the least difference
  [[nodiscard]] bool enough() const noexcept {
    return missing == 0 && !doubts.any() && !beyond_range;
  }
};
[[nodiscard]] ThresholdFinding findThreshold(std::span<const Comparison> answers,
                                             const OfferedRange& offered);

}  // namespace wholehand
