#include "commissioning/identification/regression.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kBlock_s = 1.0;
constexpr double kSettle_s = 0.3;  // settling time of the filter
constexpr double kSlowest =
    0.02;                        // of the root mean square speed: below, the direction is not known
constexpr double kCounts = 4.0;  // times the velocity noise of encoder counts
constexpr double kDelayStep = 0.25;

using Row = Eigen::Matrix<double, Regression::kColumns, 1>;

// Velocity by the derivative of a Gaussian, which is free of phase shift; 0 at both ends.
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
// for a delay of n + φ periods: a triangle of two periods over held efforts. Exact for a mass.
std::array<double, 3> weights(double phi) {
  return {0.5 * (1.0 - phi) * (1.0 - phi), 0.5 + phi * (1.0 - phi), 0.5 * phi * phi};
}

// The normal equations of one model at one delay.
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
    // Scales the terms, of very different size, to a unit diagonal.
    const Eigen::VectorXd scale = xx.diagonal().cwiseSqrt().cwiseMax(1e-200).cwiseInverse();
    const Eigen::MatrixXd scaled = scale.asDiagonal() * xx * scale.asDiagonal();
    const Eigen::VectorXd right = scale.cwiseProduct(xy);
    return scale.cwiseProduct(scaled.ldlt().solve(right));
  }
  [[nodiscard]] double left() const { return yy - xy.dot(solve()); }
};

// Sum of squares of the effort difference at two delays.
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

}  // namespace

double rootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(values.size(), 1)));
}

double resolutionOf(const AxisTrace& trace) {
  double least = 0.0, largest = 0.0;
  for (const double q : trace.position) largest = std::max(largest, std::abs(q));
  for (std::size_t k = 1; k < trace.position.size(); ++k) {
    const double step = std::abs(trace.position[k] - trace.position[k - 1]);
    if (step > 1e-12 * largest && (least == 0.0 || step < least)) least = step;
  }
  return least;
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
  constexpr double kStep = 0.05;  // periods
  const double delay = std::clamp(fitted.delay_s / period_s_, kStep, kEfforts - 3.0 - kStep);
  const Normal before(sums, model, delay - kStep), at(sums, model, delay),
      after(sums, model, delay + kStep);
  // The delay as an additional regressor: the derivative of the efforts by it.
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

}  // namespace wholehand
