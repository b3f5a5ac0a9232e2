#include "devices/commissioning/identification/identify_axis.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <vector>

namespace wholehand {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kSpring_hz = 1.5;     // natural frequency of the soft spring
constexpr double kSpringRatio = 0.7;   // damping ratio of the spring
constexpr double kSweepShare = 0.4;    // share of each posture's time for the sweep
constexpr double kFilter_s = 0.004;    // time constant of the velocity filter
constexpr double kArrive_s = 0.5;      // time from one posture's centre to the next
constexpr double kEffortShare = 0.35;  // share of the limit: amplitude of the multisine of efforts
constexpr double kReferenceEffort = 0.45;  // share of the limit: largest effort of the reference
constexpr double kTravelShare = 0.2;  // share of the travel: amplitude about a posture's centre

constexpr std::array<double, 7> kSlow_hz = {0.31, 0.67, 1.13, 1.79, 2.57, 3.61, 4.73};
constexpr std::array<double, 10> kFast_hz = {6.1,  8.3,  10.9, 13.7, 16.9,
                                             20.3, 24.7, 29.3, 34.1, 39.7};

// Phases after Schroeder (1970), for a low crest factor.
double phase(std::size_t i, std::size_t count) {
  return -std::numbers::pi * static_cast<double>(i * i) / static_cast<double>(count);
}

}  // namespace

Excitation::Excitation(const ExcitationPlan& plan) : plan_(plan) {
  ticks_ = std::llround(plan.duration_s / plan.period_s);
  const double w = kTwoPi * kSpring_hz;
  stiffness_ = plan.mass * w * w;
  damping_ = 2.0 * kSpringRatio * plan.mass * w;
  const double room = plan.effort_limit - std::abs(plan.offset);
  effort_ = kEffortShare * std::max(room, 0.0);
  const double half = 0.5 * (plan.upper - plan.lower);
  amplitude_ = std::min(2.0 * kTravelShare * half,
                        kReferenceEffort * std::max(room, 0.0) / stiffness_ * 3.0);
}

int Excitation::posture() const {
  return static_cast<int>(std::min(tick_, ticks_ - 1) * kPostures / ticks_);
}

Excitation::Target Excitation::reference(double time_s, double centre) const {
  const double length_s = plan_.duration_s / kPostures;
  const double sweep_s = kSweepShare * length_s;
  Target out{centre, 0.0};
  if (time_s < kArrive_s) return out;
  if (time_s < sweep_s) {  // one sweep to and fro at constant speed
    const double part = (time_s - kArrive_s) / (sweep_s - kArrive_s);
    const double leg = 4.0 * part;
    const double at = leg < 1.0 ? leg : leg < 3.0 ? 2.0 - leg : leg - 4.0;
    out.position += 1.5 * amplitude_ * at;
    out.velocity =
        1.5 * amplitude_ * (leg < 1.0 || leg >= 3.0 ? 4.0 : -4.0) / (sweep_s - kArrive_s);
    return out;
  }
  for (std::size_t i = 0; i < kSlow_hz.size(); ++i) {
    const double w = kTwoPi * kSlow_hz.at(i);
    const double a = amplitude_ * 0.6 / std::sqrt(static_cast<double>(kSlow_hz.size()));
    const double p = w * time_s + phase(i, kSlow_hz.size());
    out.position += a * std::sin(p);
    out.velocity += a * w * std::cos(p);
  }
  return out;
}

double Excitation::next(double position) {
  const double t = plan_.period_s;
  if (tick_ == 0) {
    last_ = position;
    wanted_ = position;
  }
  velocity_ = (kFilter_s * velocity_ + (position - last_)) / (kFilter_s + t);
  last_ = position;
  const double length_s = plan_.duration_s / kPostures;
  const double time_s = std::fmod(static_cast<double>(tick_) * t, length_s);
  const double middle = 0.5 * (plan_.lower + plan_.upper);
  const double centre =
      middle + kTravelShare * (plan_.upper - plan_.lower) * static_cast<double>(posture() - 1);
  const Target wanted = reference(time_s, centre);
  // Smooths jumps of the reference over a tenth of a second.
  wanted_ += (wanted.position - wanted_) * std::min(1.0, t / 0.05);
  double effort =
      plan_.offset + stiffness_ * (wanted_ - position) + damping_ * (wanted.velocity - velocity_);
  if (time_s >= kSweepShare * length_s) {
    for (std::size_t i = 0; i < kFast_hz.size(); ++i) {
      effort += effort_ / std::sqrt(static_cast<double>(kFast_hz.size())) *
                std::sin(kTwoPi * kFast_hz.at(i) * time_s + phase(i, kFast_hz.size()));
    }
  }
  ++tick_;
  return std::clamp(effort, -plan_.effort_limit, plan_.effort_limit);
}

namespace {

struct RegressionConfig {
  double low_pass_hz = 4.0;  ///< cut-off of the common filter, two equal poles
  double smooth_s = 0.004;   ///< Gaussian for the direction of motion
  double fade_s = 0.02;      ///< fade of the equation around a standstill
};

/// Speeds v of the Stribeck terms sign(q̇) e^(−(q̇/v)²), as shares of the RMS speed. These terms
/// are added to viscous and dry friction.
constexpr std::array<double, 4> kStribeckSpeeds = {0.07, 0.17, 0.4, 0.8};
/// Index of a Stribeck term; kPlain: none.
using FrictionModel = int;
constexpr FrictionModel kPlain = -1;

/// The filtered equation of one axis, as normal equations summed over parts of the data. Any sum of
/// parts can be fitted at no extra cost. Not real-time safe.
class Regression {
 public:
  static constexpr int kTerms = 9;     ///< q̈, q̇, sign q̇, 1, q, kStribeckSpeeds
  static constexpr int kEfforts = 14;  ///< effort of the present and earlier periods: delays up to
                                       ///< 11 periods
  static constexpr int kColumns = kTerms + kEfforts;
  using Sums = Eigen::Matrix<double, kColumns, kColumns>;

  Regression(const AxisTrace& trace, const RegressionConfig& config);

  /// Sums over blocks of one second each.
  [[nodiscard]] const std::vector<Sums>& blocks() const { return blocks_; }
  [[nodiscard]] const std::vector<Sums>& postures() const { return postures_; }
  /// Sums over the ticks below and above the RMS speed.
  [[nodiscard]] const Sums& slow() const { return slow_; }
  [[nodiscard]] const Sums& fast() const { return fast_; }
  [[nodiscard]] const Sums& all() const { return all_; }
  /// RMS of the smoothed velocity [m/s or rad/s].
  [[nodiscard]] double speed() const { return speed_; }

  /// Figures with the smallest residual; the delay to a ten-millionth of a period.
  [[nodiscard]] AxisFigures fit(const Sums& sums, FrictionModel model) const;
  /// Residual sum of squares of the filtered effort.
  [[nodiscard]] double left(const Sums& sums, FrictionModel model) const;
  /// Change of each figure that could by itself account for the residual.
  [[nodiscard]] AxisFigures hidden(const Sums& sums, const AxisFigures& fitted,
                                   FrictionModel model) const;

 private:
  double period_s_;
  double speed_ = 0.0;
  Sums all_, slow_, fast_;
  std::vector<Sums> blocks_, postures_;
};

/// Root mean square of the values; 0 without values.
double rootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

/// Smallest change of position in a trace; 0 when nothing moved [m or rad].
double resolutionOf(const AxisTrace& trace) {
  double least = 0.0, largest = 0.0;
  for (const double q : trace.position) largest = std::max(largest, std::abs(q));
  for (std::size_t k = 1; k < trace.position.size(); ++k) {
    const double step = std::abs(trace.position[k] - trace.position[k - 1]);
    if (step > 1e-12 * largest && (least == 0.0 || step < least)) least = step;
  }
  return least;
}

constexpr double kLongestGap_periods = 5.0;
constexpr double kOff_periods = 0.5;
constexpr double kMostOff = 0.05;  // share of the ticks that may be late
constexpr double kOnTime_periods = 1e-6;

Expected<Done> checkTimes(const std::vector<double>& taken_s, double period_s,
                          const std::string& axis) {
  double longest_s = 0.0;
  std::size_t off = 0;
  for (std::size_t k = 1; k < taken_s.size(); ++k) {
    const double gap_s = taken_s[k] - taken_s[k - 1];
    longest_s = std::max(longest_s, gap_s);
    off += std::abs(gap_s - period_s) > kOff_periods * period_s ? 1 : 0;
  }
  const bool gap = longest_s > kLongestGap_periods * period_s;
  if (!gap && static_cast<double>(off) <= kMostOff * static_cast<double>(taken_s.size())) {
    return Done{};
  }
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(),
                "was measured by a machine that was late: %zu of %zu ticks, at most %.1f ms apart",
                off, taken_s.size(), 1e3 * longest_s);
  return keyFault("", "axes", axis, text.data(),
                  "let nothing else run on this machine, and repeat the step");
}

// Mean effort from `from_s` to `to_s`; each effort is held until the next. `at` is the tick whose
// effort is in force at `from_s`.
double meanEffort(const AxisTrace& ticks, const std::vector<double>& taken_s, std::size_t at,
                  double from_s, double to_s) {
  double sum = 0.0, since_s = from_s;
  for (; since_s < to_s; ++at) {
    const bool last = at + 1 >= taken_s.size();
    const double until_s = last ? to_s : std::min(to_s, taken_s[at + 1]);
    sum += ticks.effort[at] * std::max(0.0, until_s - since_s);
    since_s = std::max(since_s, until_s);
    if (last) break;
  }
  return sum / (to_s - from_s);
}

constexpr double kBlock_s = 1.0;
constexpr double kSettle_s = 0.3;  // settling time of the filter
constexpr double kSlowest = 0.02;  // share of the RMS speed below which the direction is unknown
constexpr double kCounts = 4.0;    // times the noise of the velocity from encoder counts
constexpr double kDelayStep = 0.25;

using Row = Eigen::Matrix<double, Regression::kColumns, 1>;

// Velocity from the derivative of a Gaussian, which has no phase shift; 0 at both ends.
std::vector<double> smoothVelocity(const AxisTrace& trace, double sigma_s) {
  const auto reach = static_cast<std::size_t>(std::ceil(4.0 * sigma_s / trace.period_s));
  std::vector<double> kernel(reach + 1, 0.0);
  double moment_s = 0.0;
  for (std::size_t j = 1; j <= reach; ++j) {
    const double x = static_cast<double>(j) * trace.period_s / sigma_s;
    kernel[j] = x * std::exp(-0.5 * x * x);
    moment_s += 2.0 * kernel[j] * static_cast<double>(j) * trace.period_s;
  }
  std::vector<double> out(trace.position.size(), 0.0);
  for (std::size_t k = reach; k + reach < out.size(); ++k) {
    for (std::size_t j = 1; j <= reach; ++j) {
      out[k] += kernel[j] * (trace.position[k + j] - trace.position[k - j]) / moment_s;
    }
  }
  return out;
}

// Weight of the equation at each tick: 0 near standstill, 1 elsewhere.
std::vector<double> shares(const std::vector<double>& velocity, double least, int fade) {
  const std::size_t n = velocity.size();
  std::vector<int> away(n, 0);
  for (std::size_t k = 1; k < n; ++k) {
    const bool stands = std::abs(velocity[k]) < least || velocity[k] * velocity[k - 1] < 0.0;
    away[k] = stands ? 0 : std::min(fade, away[k - 1] + 1);
  }
  for (std::size_t k = n - 1; k-- > 0;) away[k] = std::min(away[k], away[k + 1] + 1);
  std::vector<double> out(n);
  std::transform(away.begin(), away.end(), out.begin(), [fade](int distance) {
    const double x = static_cast<double>(distance) / fade;
    return x * x * (3.0 - 2.0 * x);
  });
  return out;
}

// Weights of the efforts of k - n, k - n - 1, k - n - 2 in the second difference of positions at k,
// for a delay of n + φ periods: a triangle of two periods over held efforts. Exact for a pure mass.
std::array<double, 3> weights(double phi) {
  return {0.5 * (1.0 - phi) * (1.0 - phi), 0.5 + phi * (1.0 - phi), 0.5 * phi * phi};
}

// Normal equations of one model at one delay.
struct Normal {
  Eigen::MatrixXd xx;
  Eigen::VectorXd xy;
  double yy = 0.0;

  Normal(const Regression::Sums& sums, FrictionModel model, double delay_periods) {
    std::vector<int> terms = {0, 1, 2, 3, 4};
    if (model != kPlain) terms.push_back(5 + model);
    const auto whole = static_cast<int>(std::floor(delay_periods));
    const std::array<double, 3> w = weights(delay_periods - whole);
    const int first = Regression::kTerms + whole;
    const Eigen::Vector3d weight(w[0], w[1], w[2]);
    xx = sums(terms, terms);
    xy = sums(terms, Eigen::seqN(first, 3)) * weight;
    yy = weight.dot(sums.block<3, 3>(first, first) * weight);
  }

  [[nodiscard]] Eigen::VectorXd solve() const {
    // The terms differ much in size, so they are scaled to a unit diagonal.
    const Eigen::VectorXd scale = xx.diagonal().cwiseSqrt().cwiseMax(1e-200).cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * xx * scale.asDiagonal();
    const Eigen::VectorXd right = scale.cwiseProduct(xy);
    return scale.cwiseProduct(scaled.ldlt().solve(right));
  }
  [[nodiscard]] double left() const { return yy - xy.dot(solve()); }
};

// Sum of squares of the difference between the efforts at two delays.
double effortsApart(const Regression::Sums& sums, double one, double other) {
  Eigen::VectorXd weight = Eigen::VectorXd::Zero(Regression::kEfforts);
  const auto add = [&weight](double delay, double sign) {
    const auto whole = static_cast<int>(std::floor(delay));
    const std::array<double, 3> w = weights(delay - whole);
    for (int i = 0; i < 3; ++i) weight[whole + i] += sign * w.at(i);
  };
  add(one, 1.0);
  add(other, -1.0);
  return weight.dot(sums.bottomRightCorner<Regression::kEfforts, Regression::kEfforts>() * weight);
}

double bestDelay(const Regression::Sums& sums, FrictionModel model) {
  const auto left = [&](double delay) { return Normal(sums, model, delay).left(); };
  double best = 0.0, least = left(0.0);
  for (double d = kDelayStep; d <= Regression::kEfforts - 3; d += kDelayStep) {
    const double l = left(d);
    if (l < least) least = l, best = d;
  }
  double low = std::max(0.0, best - kDelayStep);
  double high = std::min(best + kDelayStep, Regression::kEfforts - 3.0);
  constexpr double kGolden = 0.6180339887498949;
  while (high - low > 1e-7) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    if (left(a) < left(b)) {
      high = b;
    } else {
      low = a;
    }
  }
  return 0.5 * (low + high);
}

constexpr double kShortest_s = 6.0;
constexpr double kStudent = 3.0;  // standard deviations: 99.5 % with some 15 blocks
// Factor for the difference between a part of the data and the whole. It exceeds 1 because every
// part contains some of the disturbance of the whole.
constexpr double kExtrapolation = 2.0;
// Share of the unexplained effort that mass and delay may hide, as with play.
constexpr double kHidden = 0.8;
// Smallest half widths. Tests show that the method keeps them on ideal axes.
constexpr double kLeastMass = 0.02, kLeastFriction = 0.05, kLeastDelay_periods = 0.1;
// Largest half width relative to the middle. A certificate cannot use wider intervals.
constexpr double kMassWithin = 0.2, kDampingWithin = 0.35, kCoulombWithin = 0.5;
constexpr double kDelayWithin_periods = 2.5;
constexpr double kCoulombOfEffort = 0.05;  // share of the effort below which dry friction is
                                           // negligible

using Figures = std::array<double, 5>;  // mass, damping, coulomb, gravity, delay
constexpr double kSlowShare = 0.15;     // smallest Stribeck speed that counts, share of the RMS
                                        // speed
constexpr double kExplains = 0.8;       // a model counts if its residual is below this share of the
                                        // plain one
enum : std::size_t { kMass, kDamping, kCoulomb, kGravity, kDelay };

Figures listed(const AxisFigures& f) {
  return {f.mass, f.damping, f.coulomb, f.gravity, f.delay_s};
}

// Standard deviations of the figures, from fits that each omit one block (jackknife).
Figures scatterOf(const Regression& regression) {
  std::vector<Figures> without;
  for (const Regression::Sums& block : regression.blocks()) {
    if (block.isZero(0.0)) continue;
    without.push_back(listed(regression.fit(regression.all() - block, kPlain)));
  }
  const auto n = static_cast<double>(without.size());
  Figures out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    double mean = 0.0, sum = 0.0;
    for (const Figures& f : without) mean += f.at(i) / n;
    for (const Figures& f : without) sum += (f.at(i) - mean) * (f.at(i) - mean);
    out.at(i) = std::sqrt((n - 1.0) / n * sum);
  }
  return out;
}

// Estimates of the same figures from parts of the data and from other friction models.
std::vector<Figures> partialEstimates(const AxisTrace& trace, const Regression& whole) {
  std::vector<Figures> out;
  for (std::size_t i = 0; i < kStribeckSpeeds.size(); ++i) {
    out.push_back(listed(whole.fit(whole.all(), static_cast<FrictionModel>(i))));
  }
  for (const Regression::Sums& posture : whole.postures()) {
    out.push_back(listed(whole.fit(posture, kPlain)));
  }
  out.push_back(listed(whole.fit(whole.slow(), kPlain)));
  out.push_back(listed(whole.fit(whole.fast(), kPlain)));
  for (const double low_pass_hz : {1.5, 12.0}) {
    RegressionConfig config;
    config.low_pass_hz = low_pass_hz;
    const Regression band(trace, config);
    out.push_back(listed(band.fit(band.all(), kPlain)));
  }
  return out;
}

std::array<Interval, 5> intervals(const Figures& middle, const Figures& scatter,
                                  const std::vector<Figures>& others, const Figures& least) {
  std::array<Interval, 5> out;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double wide = std::max(kStudent * scatter.at(i), least.at(i));
    out.at(i) = {middle.at(i) - wide, middle.at(i) + wide};
    for (const Figures& other : others) {
      const double there = middle.at(i) + kExtrapolation * (other.at(i) - middle.at(i));
      out.at(i) = hull(out.at(i), {there, there});
    }
  }
  return out;
}

// True when a friction that falls with speed over much of the speed range fits much better.
bool fallsWithSpeed(const Regression& whole) {
  const double plain = whole.left(whole.all(), kPlain);
  double least = plain;
  std::size_t best = 0;
  for (std::size_t i = 0; i < kStribeckSpeeds.size(); ++i) {
    const double left = whole.left(whole.all(), static_cast<FrictionModel>(i));
    if (left < least) least = left, best = i;
  }
  return kStribeckSpeeds.at(best) >= kSlowShare && least < kExplains * plain;
}

std::string percent(double share) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.0f %%", 100.0 * share);
  return text.data();
}

// Reasons why a certificate cannot use these intervals; empty when it can.
Diagnostics refusals(const IdentifiedAxis& found, const std::string& axis, double period_s,
                     double effort) {
  Diagnostics out;
  const auto refuse = [&](const std::string& problem, const std::string& remedy) {
    out.push_back({"", 0, "axes", axis, problem, remedy});
  };
  const auto spread = [](const Interval& i) { return i.halfWidth() / std::abs(i.middle()); };
  if (!(found.mass.lower > 0.0) || spread(found.mass) > kMassWithin) {
    refuse(
        "its mass is not one number: parts of the motion differ by " + percent(spread(found.mass)),
        "look for play, a slack belt or a soft joint between motor and handle");
  }
  if (!(found.damping.upper > 0.0) || spread(found.damping) > kDampingWithin) {
    refuse("its friction is not viscous and dry: the damping of parts of the motion differs by " +
               percent(spread(found.damping)),
           "look for friction that falls with speed, cogging or a rubbing cable");
  }
  const bool felt = found.coulomb.upper > kCoulombOfEffort * effort;
  if (felt && spread(found.coulomb) > kCoulombWithin) {
    refuse("its dry friction is not one number: parts of the motion differ by " +
               percent(spread(found.coulomb)),
           "look for cogging, a rubbing cable or a bearing that sticks");
  }
  if (found.delay_s.halfWidth() > kDelayWithin_periods * period_s) {
    refuse("its delay is not one number", "look for play, and for a bus that is sometimes late");
  }
  return out;
}

// Figures from a band that reaches beyond the corner frequency b/m: below it, a larger mass
// resembles a longer delay. The encoder's steps rule out the wider band for some axes.
AxisFigures refined(const AxisTrace& trace, const IdentifiedAxis& found) {
  constexpr double kLeast_hz = 6.0, kCorners = 1.5;
  RegressionConfig config;
  const double corner_hz = found.figures.damping / found.figures.mass / (2.0 * std::numbers::pi);
  config.low_pass_hz = std::max(kLeast_hz, kCorners * corner_hz);
  const Regression band(trace, config);
  const AxisFigures f = band.fit(band.all(), kPlain);
  const auto within = [](const Interval& i, double x) { return std::clamp(x, i.lower, i.upper); };
  return {within(found.mass, f.mass), within(found.damping, f.damping),
          within(found.coulomb, f.coulomb), within(found.gravity, f.gravity),
          within(found.delay_s, f.delay_s)};
}

}  // namespace

Expected<AxisTrace> evenTrace(const AxisTrace& ticks, const std::vector<double>& taken_s,
                              const std::string& axis) {
  const double t = ticks.period_s;
  const std::size_t n = taken_s.size();
  if (n == 0 || ticks.position.size() != n || ticks.effort.size() != n) return ticks;
  bool on_time = true;
  for (std::size_t k = 0; k < n; ++k) {
    on_time &= std::abs(taken_s[k] - static_cast<double>(k) * t) < kOnTime_periods * t;
  }
  if (on_time) return ticks;
  if (auto good = checkTimes(taken_s, t, axis); !good) return good.errors();
  AxisTrace out;
  out.period_s = t;
  std::size_t at = 0;
  for (std::size_t k = 0;; ++k) {
    const double time_s = static_cast<double>(k) * t;
    while (at + 1 < n && taken_s[at + 1] <= time_s) ++at;
    if (at + 1 >= n) break;
    const double share = (time_s - taken_s[at]) / (taken_s[at + 1] - taken_s[at]);
    out.position.push_back(ticks.position[at] +
                           share * (ticks.position[at + 1] - ticks.position[at]));
    out.effort.push_back(meanEffort(ticks, taken_s, at, time_s, time_s + t));
    out.posture.push_back(ticks.posture[at]);
  }
  return out;
}

Regression::Regression(const AxisTrace& trace, const RegressionConfig& config)
    : period_s_(trace.period_s), all_(Sums::Zero()), slow_(Sums::Zero()), fast_(Sums::Zero()) {
  const double t = trace.period_s;
  const std::size_t n = trace.position.size();
  const std::vector<double> v = smoothVelocity(trace, config.smooth_s);
  speed_ = rootMeanSquare(v);
  const double noise =
      resolutionOf(trace) / std::sqrt(12.0) *
      std::sqrt(t / (4.0 * std::sqrt(std::numbers::pi) * std::pow(config.smooth_s, 3)));
  const std::vector<double> share =
      shares(v, std::max(kCounts * noise, kSlowest * speed_),
             std::max(1, static_cast<int>(std::ceil(config.fade_s / t))));
  double middle = 0.0;
  for (const double q : trace.position) middle += q / static_cast<double>(n);

  const double pole = std::exp(-2.0 * std::numbers::pi * config.low_pass_hz * t);
  const std::size_t per_block = std::llround(kBlock_s / t);
  const std::size_t settled = std::llround(kSettle_s / t);
  blocks_.assign(n / per_block + 1, Sums::Zero());
  postures_.assign(trace.posture.back() + 1, Sums::Zero());
  Row once = Row::Zero(), twice = Row::Zero();
  for (std::size_t k = kEfforts; k + 1 < n; ++k) {
    const double before = trace.position[k - 1], now = trace.position[k],
                 after = trace.position[k + 1];
    const double direction = v[k] > 0.0 ? 1.0 : -1.0, pace = std::abs(v[k]) / speed_;
    Row row;
    row.head<5>() << (after - 2.0 * now + before) / (t * t), (after - before) / (2.0 * t),
        direction, 1.0, now - middle;
    for (std::size_t i = 0; i < kStribeckSpeeds.size(); ++i) {
      const double x = pace / kStribeckSpeeds.at(i);
      row[5 + static_cast<int>(i)] = direction * std::exp(-x * x);
    }
    for (int d = 0; d < kEfforts; ++d) row[kTerms + d] = trace.effort[k - d];
    once = pole * once + (1.0 - pole) * share[k] * row;
    twice = pole * twice + (1.0 - pole) * once;
    if (k < settled) continue;
    const Sums outer = twice * twice.transpose();
    blocks_[k / per_block] += outer;
    postures_[trace.posture[k]] += outer;
    (pace < 1.0 ? slow_ : fast_) += outer;
    all_ += outer;
  }
}

double Regression::left(const Sums& sums, FrictionModel model) const {
  return Normal(sums, model, bestDelay(sums, model)).left();
}

AxisFigures Regression::hidden(const Sums& sums, const AxisFigures& fitted,
                               FrictionModel model) const {
  constexpr double kStep = 0.05;  // step in periods
  const double delay = std::clamp(fitted.delay_s / period_s_, kStep, kEfforts - 3.0 - kStep);
  const Normal before(sums, model, delay - kStep), at(sums, model, delay),
      after(sums, model, delay + kStep);
  // The delay enters as an additional regressor: the derivative of the efforts with respect to it.
  const Eigen::Index n = at.xx.rows();
  Eigen::MatrixXd xx(n + 1, n + 1);
  xx.topLeftCorner(n, n) = at.xx;
  xx.col(n).head(n) = (after.xy - before.xy) / (2.0 * kStep);
  xx.row(n) = xx.col(n).transpose();
  xx(n, n) = effortsApart(sums, delay - kStep, delay + kStep) / (4.0 * kStep * kStep);
  const Eigen::VectorXd scale = xx.diagonal().cwiseSqrt().cwiseMax(1e-200).cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * xx * scale.asDiagonal();
  const Eigen::MatrixXd inverse = scaled.ldlt().solve(Eigen::MatrixXd::Identity(n + 1, n + 1));
  const double left = std::max(0.0, at.left());
  const auto bound = [&](Eigen::Index i) {
    return std::sqrt(left * std::max(0.0, inverse(i, i))) * scale[i];
  };
  return {bound(0), bound(1), bound(2), bound(3), bound(n) * period_s_};
}

AxisFigures Regression::fit(const Sums& sums, FrictionModel model) const {
  const double delay = bestDelay(sums, model);
  const Eigen::VectorXd x = Normal(sums, model, delay).solve();
  return {x[0], x[1], x[2], x[3], delay * period_s_};
}

Expected<IdentifiedAxis> identifyAxis(const AxisTrace& trace, const std::string& axis) {
  const double t = trace.period_s;
  const auto refused = [&axis](const char* problem, const char* remedy) {
    return Diagnostic{"", 0, "axes", axis, problem, remedy};
  };
  const std::size_t n = trace.position.size();
  if (static_cast<double>(n) * t < kShortest_s || trace.effort.size() != n ||
      trace.posture.size() != n) {
    return refused("was not measured for long enough", "measure it for 20 s");
  }
  IdentifiedAxis out;
  out.resolution = resolutionOf(trace);
  const auto [low, high] = std::minmax_element(trace.position.begin(), trace.position.end());
  if (!(*high - *low > 50.0 * out.resolution)) {
    return refused("did not move under the efforts that may be used",
                   "look for a brake, dry friction or an encoder that is too coarse");
  }
  const Regression whole(trace, {});
  out.figures = whole.fit(whole.all(), kPlain);
  if (fallsWithSpeed(whole)) {
    return refused("its friction falls with speed: it is not viscous and dry",
                   "look for a bearing or a seal that sticks, and lubricate it");
  }
  const Figures middle = listed(out.figures);
  const double effort = rootMeanSquare(trace.effort);
  const AxisFigures hidden = whole.hidden(whole.all(), out.figures, kPlain);
  const Figures least = {std::max(kLeastMass * std::abs(middle[kMass]), kHidden * hidden.mass),
                         kLeastFriction * std::abs(middle[kDamping]),
                         kLeastFriction * std::abs(middle[kCoulomb]), 0.01 * effort,
                         std::max(kLeastDelay_periods * t, kHidden * hidden.delay_s)};
  const auto found = intervals(middle, scatterOf(whole), partialEstimates(trace, whole), least);
  out.mass = found[kMass];
  out.damping = found[kDamping];
  out.coulomb = found[kCoulomb];
  out.gravity = found[kGravity];
  out.delay_s = found[kDelay];
  if (Diagnostics no = refusals(out, axis, t, effort); !no.empty()) return no;
  out.figures = refined(trace, out);
  return out;
}

}  // namespace wholehand
