#include "loop/psychometrics/threshold.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace wholehand {
namespace {

using std::numbers::pi, std::numbers::sqrt2;

constexpr double kPriorSigma = 0.2, kPriorSpread = 2.0, kBiasSpread = 0.5;
constexpr double kLeastSigma = 0.005, kMostSigma = 5.0, kMostBias = 1.5;
/// Drop of the profile to the ends of a 95 % interval. Half the quantile of χ², 1.92, is that of
/// many answers; with fifty it covers too little.
constexpr double kDrop = 2.15;

double normal(double z) noexcept {
  return 0.5 * std::erfc(-z / sqrt2);
}
double density(double z) noexcept {
  return std::exp(-0.5 * z * z) / std::sqrt(2.0 * pi);
}

/// z with Φ(z) = p, by bisection.
double quantile(double p) noexcept {
  double low = -10.0, high = 10.0;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (normal(middle) < p ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Difference that the person compares: x, or the other one.
enum class Compared { kX, kOther };
double differenceOf(const Comparison& answer, Compared what) noexcept {
  return what == Compared::kX ? answer.x : answer.other;
}

double priorOf(const Observer& o) noexcept {
  const double s = std::log(o.sigma / kPriorSigma) / kPriorSpread, b = o.bias / kBiasSpread;
  return -0.5 * (s * s + b * b);
}

double likelihood(const Observer& o, std::span<const Comparison> answers, Compared what) {
  double sum = 0.0;
  for (const Comparison& answer : answers) {
    const double z = (differenceOf(answer, what) + o.bias) / (sqrt2 * o.sigma);
    // The smaller of both probabilities keeps its digits.
    const double says = answer.said_second ? normal(z) : normal(-z);
    sum += std::log(0.5 * o.lapse + (1.0 - o.lapse) * says);
  }
  return sum;
}

/// Gradient and Fisher information of the posterior in bias and lapse, at fixed σ.
struct Slope {
  double bias = 0.0, lapse = 0.0;
  double bias2 = 0.0, both = 0.0, lapse2 = 0.0;
};
Slope slopeOf(const Observer& o, std::span<const Comparison> answers, Compared what) {
  Slope out;
  for (const Comparison& answer : answers) {
    const double z = (differenceOf(answer, what) + o.bias) / (sqrt2 * o.sigma);
    const double f = normal(z), p = 0.5 * o.lapse + (1.0 - o.lapse) * f;
    const double q = 0.5 * o.lapse + (1.0 - o.lapse) * normal(-z);
    if (!(p * q > 1e-300)) continue;
    const double by_bias = (1.0 - o.lapse) * density(z) / (sqrt2 * o.sigma), by_lapse = 0.5 - f;
    const double weight = answer.said_second ? 1.0 / p : -1.0 / q;
    out.bias += weight * by_bias;
    out.lapse += weight * by_lapse;
    out.bias2 += by_bias * by_bias / (p * q);
    out.both += by_bias * by_lapse / (p * q);
    out.lapse2 += by_lapse * by_lapse / (p * q);
  }
  out.bias -= o.bias / (kBiasSpread * kBiasSpread);
  out.bias2 += 1.0 / (kBiasSpread * kBiasSpread);
  return out;
}

/// Tries a step of bias and lapse, halved until the posterior rises. Returns whether it rose.
bool step(double bias, double lapse, std::span<const Comparison> answers, Compared what,
          Observer& o, double& best) {
  for (double share = 1.0; share > 1e-4; share *= 0.5) {
    Observer tried = o;
    tried.bias = std::clamp(o.bias + share * bias, -kMostBias, kMostBias);
    tried.lapse = std::clamp(o.lapse + share * lapse, 0.0, kMostLapse);
    const double value = likelihood(tried, answers, what) + priorOf(tried);
    if (!(value > best)) continue;
    const bool rose = value - best > 1e-10;
    best = value;
    o = tried;
    return rose;
  }
  return false;
}

/// Raises the posterior over bias and lapse at the observer's σ, by scoring: both at once, or one
/// of them where that does not rise, at a bound of the lapse for instance. Returns the top.
double climb(Observer& o, std::span<const Comparison> answers, Compared what) {
  constexpr double kNothing = 1e-11;  // a gain that ends the climb
  double best = likelihood(o, answers, what) + priorOf(o);
  for (int round = 0; round < 200; ++round) {
    const Slope s = slopeOf(o, answers, what);
    const double determinant = s.bias2 * s.lapse2 - s.both * s.both;
    const bool held = (o.lapse <= 0.0 && s.lapse < 0.0) || (o.lapse >= kMostLapse && s.lapse > 0.0);
    if (!held && determinant > 1e-12 * s.bias2 * s.lapse2) {
      const double bias = (s.lapse2 * s.bias - s.both * s.lapse) / determinant;
      const double lapse = (s.bias2 * s.lapse - s.both * s.bias) / determinant;
      if (s.bias * bias + s.lapse * lapse < kNothing) return best;
      if (step(bias, lapse, answers, what, o, best)) continue;
    }
    const bool bias_rose =
        s.bias * s.bias / s.bias2 > kNothing && step(s.bias / s.bias2, 0.0, answers, what, o, best);
    const bool lapse_rose = !held && s.lapse * s.lapse > kNothing * s.lapse2 &&
                            step(0.0, s.lapse / s.lapse2, answers, what, o, best);
    if (!bias_rose && !lapse_rose) return best;
  }
  return best;
}

/// The bias with the largest posterior among those halfway between the differences: with a small σ
/// the posterior has a step at each difference, and a top between any two of them.
double bestStep(Observer o, std::span<const Comparison> answers, Compared what) {
  std::vector<double> steps{-kMostBias, kMostBias};
  for (const Comparison& answer : answers) steps.push_back(-differenceOf(answer, what));
  std::sort(steps.begin(), steps.end());
  double best = -std::numeric_limits<double>::infinity(), bias = 0.0;
  for (std::size_t i = 1; i < steps.size(); ++i) {
    if (steps[i] == steps[i - 1]) continue;
    o.bias = 0.5 * (steps[i] + steps[i - 1]);
    const double value = likelihood(o, answers, what) + priorOf(o);
    if (value > best) best = value, bias = o.bias;
  }
  return bias;
}

/// Largest posterior at ln σ = u. It is climbed to from the bias of `at` and from four others,
/// since it may have several tops; and from half the most lapses: from none a rise is slow where an
/// answer is very improbable.
double profile(double u, std::span<const Comparison> answers, Compared what, Observer& at) {
  double best = -std::numeric_limits<double>::infinity();
  const double before = at.bias;
  const Observer start{std::exp(u), 0.0, 0.5 * kMostLapse};
  for (const double bias : {before, bestStep(start, answers, what), 0.0, -0.4, 0.4}) {
    Observer o = start;
    o.bias = bias;
    const double value = climb(o, answers, what);
    if (value > best) best = value, at = o;
  }
  return best;
}

struct Peak {
  double u = 0.0, value = 0.0;
  Observer observer;
};

/// The top over ln σ: the best of a grid, then a golden section beside it.
Peak peakOf(std::span<const Comparison> answers, Compared what) {
  const double low = std::log(kLeastSigma), high = std::log(kMostSigma);
  constexpr int kGrid = 20;
  Peak peak;
  peak.value = -std::numeric_limits<double>::infinity();
  Observer o{0.0, 0.0, 0.5 * kMostLapse};
  for (int i = 0; i <= kGrid; ++i) {
    const double u = low + (high - low) * i / kGrid;
    const double value = profile(u, answers, what, o);
    if (value > peak.value) peak = {u, value, o};
  }
  const double ratio = 0.5 * (std::sqrt(5.0) - 1.0), step = (high - low) / kGrid;
  o = peak.observer;
  double a = std::max(low, peak.u - step), b = std::min(high, peak.u + step);
  double c = b - ratio * (b - a), d = a + ratio * (b - a);
  double at_c = profile(c, answers, what, o), at_d = profile(d, answers, what, o);
  for (int i = 0; i < 40; ++i) {
    if (at_c > at_d) {
      b = d, d = c, at_d = at_c;
      c = b - ratio * (b - a);
      at_c = profile(c, answers, what, o);
    } else {
      a = c, c = d, at_c = at_d;
      d = a + ratio * (b - a);
      at_d = profile(d, answers, what, o);
    }
  }
  const double u = 0.5 * (a + b), value = profile(u, answers, what, o);
  return {u, value, o};
}

/// ln σ at which the profile has dropped to `level` between the top and `end`; `end` if it does
/// not.
double crossing(const Peak& top, double end, double level, std::span<const Comparison> answers) {
  Observer o = top.observer;
  if (profile(end, answers, Compared::kX, o) >= level) return end;
  double inside = top.u, outside = end;
  o = top.observer;
  for (int i = 0; i < 40; ++i) {
    const double u = 0.5 * (inside + outside);
    (profile(u, answers, Compared::kX, o) >= level ? inside : outside) = u;
  }
  return 0.5 * (inside + outside);
}

/// Likelihood of answers that do not depend on anything: the same chance of "second" each time.
double sameChance(std::span<const Comparison> answers) {
  double second = 0.0;
  for (const Comparison& answer : answers) second += answer.said_second ? 1.0 : 0.0;
  const double n = static_cast<double>(answers.size()), p = second / n;
  double sum = 0.0;
  if (second > 0.0) sum += second * std::log(p);
  if (second < n) sum += (n - second) * std::log1p(-p);
  return sum;
}

/// Chance that this observer misses at least as many catch comparisons as were missed.
double chanceOfMisses(const Observer& observer, std::span<const Comparison> answers) {
  std::vector<double> chance{1.0};  // of 0, 1, 2 ... misses
  std::size_t missed = 0;
  for (const Comparison& answer : answers) {
    if (!answer.is_catch) continue;
    missed += answer.right() ? 0 : 1;
    const double second = observer.saysSecond(answer.x);
    const double miss = answer.x > 0.0 ? 1.0 - second : second;
    chance.push_back(0.0);
    for (std::size_t k = chance.size() - 1; k > 0; --k) {
      chance[k] = (1.0 - miss) * chance[k] + miss * chance[k - 1];
    }
    chance[0] *= 1.0 - miss;
  }
  double as_many = 0.0;
  for (std::size_t k = missed; k < chance.size(); ++k) as_many += chance[k];
  return as_many;
}

}  // namespace

double Observer::saysSecond(double x) const noexcept {
  return 0.5 * lapse + (1.0 - lapse) * normal((x + bias) / (sqrt2 * sigma));
}

double Observer::right(double x) const noexcept {
  return 0.5 * (saysSecond(x) + 1.0 - saysSecond(-x));
}

double sigmaOfWeber(double fraction, double right) noexcept {
  return std::log1p(fraction) / (sqrt2 * quantile(right));
}

double logLikelihood(const Observer& observer, std::span<const Comparison> answers) {
  return likelihood(observer, answers, Compared::kX);
}

double logPosterior(const Observer& observer, std::span<const Comparison> answers) {
  return logLikelihood(observer, answers) + priorOf(observer);
}

Threshold fitThreshold(std::span<const Comparison> answers) {
  const Peak peak = peakOf(answers, Compared::kX);
  const double least = std::log(kLeastSigma), most = std::log(kMostSigma);
  const double low = crossing(peak, least, peak.value - kDrop, answers);
  const double high = crossing(peak, most, peak.value - kDrop, answers);
  return {peak.observer, std::exp(low), std::exp(high), low <= least, high >= most};
}

ThresholdDoubts doubtsAbout(std::span<const Comparison> answers) {
  // Bounds, in ln of a ratio of likelihoods: `experiment thresholds` shows what they flag.
  constexpr double kBetterThanChance = 2.8, kBetterByOther = 1.0;
  constexpr double kNearlyAlways = 0.9, kUnlikely = 0.002;
  ThresholdDoubts out;
  const Observer fitted = peakOf(answers, Compared::kX).observer;
  const double by_x = likelihood(fitted, answers, Compared::kX);
  const double by_other =
      likelihood(peakOf(answers, Compared::kOther).observer, answers, Compared::kOther);
  out.guesses = by_x - sameChance(answers) < kBetterThanChance;
  out.compares_other = by_other - by_x > kBetterByOther;
  double second = 0.0, varied = 0.0, right_by_other = 0.0;
  for (const Comparison& answer : answers) {
    second += answer.said_second ? 1.0 : 0.0;
    if (answer.other == 0.0) continue;
    varied += 1.0;
    right_by_other += (answer.other > 0.0) == (answer.x > 0.0) ? 1.0 : 0.0;
  }
  if (varied > 0.0) out.other_right = right_by_other / varied;
  const double share = second / static_cast<double>(answers.size());
  out.one_answer = share > kNearlyAlways || share < 1.0 - kNearlyAlways;
  out.misses_catches = chanceOfMisses(fitted, answers) < kUnlikely;
  return out;
}

double ratioAtThreeOfFour(double sigma) noexcept {
  return std::exp(sqrt2 * sigma * quantile(0.75));
}

ThresholdFinding findThreshold(std::span<const Comparison> answers, const OfferedRange& offered) {
  ThresholdFinding out;
  out.missing = std::max(0, kLeastAnswers - static_cast<int>(answers.size()));
  if (answers.empty()) return out;
  out.threshold = fitThreshold(answers);
  out.doubts = doubtsAbout(answers);
  const double sigma = out.threshold.observer.sigma;
  out.beyond_range = sigma > offered.most / kSigmasInRange;
  out.at_device_limit = std::log(ratioAtThreeOfFour(sigma)) < offered.least;
  return out;
}

}  // namespace wholehand
