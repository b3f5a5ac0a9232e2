#include "device/simulated/box_problem.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kRounding = 1e-13;  // relative to the terms of a sum
constexpr int kBlockTries = 3;       // attempts without progress before single pivots
constexpr int kMostPivots = 2000;    // usually a few

/// λ with the axes at an end fixed there; false where G has no factorisation.
bool solveBetween(const AxisMatrix& g, const AxisColumn& w, const AxisColumn& lower,
                  const AxisColumn& upper, const RangeParts& parts, AxisColumn& lambda) noexcept {
  std::array<Eigen::Index, kMaxAxes> between{};
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    const RangePart part = parts[i];
    lambda[i] = part == RangePart::kLow ? lower[i] : part == RangePart::kHigh ? upper[i] : 0.0;
    if (part == RangePart::kBetween) between[count++] = i;
  }
  if (count == 0) return true;
  AxisMatrix block(count, count);
  AxisColumn wanted(count);
  for (Eigen::Index a = 0; a < count; ++a) {
    const Eigen::Index i = between[a];
    wanted[a] = -w[i];
    for (Eigen::Index k = 0; k < w.size(); ++k) wanted[a] -= g(i, k) * lambda[k];
    for (Eigen::Index b = 0; b < count; ++b) {
      block(a, b) = g(i, between[b]);
    }
  }
  const Eigen::LLT<AxisMatrix> cholesky(block);
  if (cholesky.info() != Eigen::Success) return false;
  cholesky.solveInPlace(wanted);
  for (Eigen::Index a = 0; a < count; ++a) lambda[between[a]] = wanted[a];
  return true;
}

/// Range part that an axis must change to; the same if it is consistent.
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
    RangePart& part = parts[i];
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
      next[i] = better(parts[i], lambda[i], lower[i], upper[i], v, size);
      if (next[i] == parts[i]) continue;
      ++faulty;
      last = i;
    }
    if (faulty == 0) return true;
    tries = faulty < fewest ? kBlockTries : tries - 1;
    fewest = std::min(fewest, faulty);
    if (tries >= 0) {
      parts = next;
    } else {  // Murty: only the last axis
      parts[last] = next[last];
    }
  }
  return false;
}

}  // namespace wholehand
