#include "device/simulated/box_problem.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kRounding = 1e-13;  // of the terms that a number is the sum of
constexpr int kBlockTries = 3;       // without fewer axes at fault, before single pivots
constexpr int kMostPivots = 2000;    // a few as a rule

/// λ where the ends are taken as given; false where G has no factors there.
bool solveBetween(const AxisMatrix& g, const AxisColumn& w, const AxisColumn& lower,
                  const AxisColumn& upper, const RangeParts& parts, AxisColumn& lambda) noexcept {
  std::array<Eigen::Index, kMaxAxes> between{};
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    const RangePart part = parts[static_cast<std::size_t>(i)];
    lambda[i] = part == RangePart::kLow ? lower[i] : part == RangePart::kHigh ? upper[i] : 0.0;
    if (part == RangePart::kBetween) between[static_cast<std::size_t>(count++)] = i;
  }
  if (count == 0) return true;
  AxisMatrix block(count, count);
  AxisColumn wanted(count);
  for (Eigen::Index a = 0; a < count; ++a) {
    const Eigen::Index i = between[static_cast<std::size_t>(a)];
    wanted[a] = -w[i];
    for (Eigen::Index k = 0; k < w.size(); ++k) wanted[a] -= g(i, k) * lambda[k];
    for (Eigen::Index b = 0; b < count; ++b) {
      block(a, b) = g(i, between[static_cast<std::size_t>(b)]);
    }
  }
  const Eigen::LLT<AxisMatrix> cholesky(block);
  if (cholesky.info() != Eigen::Success) return false;
  cholesky.solveInPlace(wanted);
  for (Eigen::Index a = 0; a < count; ++a) lambda[between[static_cast<std::size_t>(a)]] = wanted[a];
  return true;
}

/// Where an axis must go that is not where it should be; else where it is.
RangePart better(RangePart part, double lambda, double lower, double upper, double v,
                 double v_size) noexcept {
  if (part == RangePart::kBetween) {
    const double slack = kRounding * std::abs(lambda);
    if (lambda < lower - slack) return RangePart::kLow;
    if (lambda > upper + slack) return RangePart::kHigh;
    return part;
  }
  if (lower == upper) return part;
  const double slack = kRounding * v_size;
  if (part == RangePart::kLow && v < -slack) return RangePart::kBetween;
  if (part == RangePart::kHigh && v > slack) return RangePart::kBetween;
  return part;
}

}  // namespace

bool solveBox(const AxisMatrix& g, const AxisColumn& w, const AxisColumn& lower,
              const AxisColumn& upper, RangeParts& parts, AxisColumn& lambda) noexcept {
  const Eigen::Index n = w.size();
  lambda.resize(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    RangePart& part = parts[static_cast<std::size_t>(i)];
    if (lower[i] == upper[i]) part = RangePart::kLow;
    if (part == RangePart::kLow && !std::isfinite(lower[i])) part = RangePart::kBetween;
    if (part == RangePart::kHigh && !std::isfinite(upper[i])) part = RangePart::kBetween;
  }
  Eigen::Index fewest = n + 1;
  int tries = kBlockTries;
  for (int pivot = 0; pivot < kMostPivots; ++pivot) {
    if (!solveBetween(g, w, lower, upper, parts, lambda)) return false;
    RangeParts next = parts;
    Eigen::Index faulty = 0, last = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      double v = w[i], size = std::abs(w[i]);
      for (Eigen::Index k = 0; k < n; ++k) {
        v += g(i, k) * lambda[k];
        size += std::abs(g(i, k) * lambda[k]);
      }
      const auto at = static_cast<std::size_t>(i);
      next[at] = better(parts[at], lambda[i], lower[i], upper[i], v, size);
      if (next[at] == parts[at]) continue;
      ++faulty;
      last = i;
    }
    if (faulty == 0) return true;
    tries = faulty < fewest ? kBlockTries : tries - 1;
    fewest = std::min(fewest, faulty);
    if (tries >= 0) {
      parts = next;
    } else {  // Murty: the last one only
      parts[static_cast<std::size_t>(last)] = next[static_cast<std::size_t>(last)];
    }
  }
  return false;
}

}  // namespace wholehand
