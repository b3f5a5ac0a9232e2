#include "telemetry/posture_inertia.hpp"

#include <algorithm>

namespace wholehand::recording {

PostureInertia::PostureInertia(const RecordedInertia& inertia, std::size_t axes)
    : axes_(axes), degrees_(2), lower_(inertia.lower), upper_(inertia.upper) {
  for (const double degree : inertia.degrees) {
    degrees_ = std::max(degrees_, static_cast<std::size_t>(degree) + 1);
  }
  const std::size_t size = axes * (axes + 1) / 2;
  for (std::size_t t = 0; t < inertia.degrees.size() / axes; ++t) {
    Term& term = terms_.emplace_back();
    for (std::size_t a = 0; a < axes; ++a) {
      const auto degree = static_cast<std::size_t>(inertia.degrees[t * axes + a]);
      if (degree > 0) term.factors.push_back(a * degrees_ + degree);
    }
    for (std::size_t k = 0; k < size; ++k) {
      const double coefficient = inertia.coefficients[t * size + k];
      if (coefficient != 0.0) term.coefficients.emplace_back(k, coefficient);
    }
  }
  chebyshev_.resize(axes_ * degrees_);
  matrix_.resize(size);
}

// Chebyshev polynomials of each axis, whose range is -1 .. 1.
void PostureInertia::fillChebyshev(const std::vector<double>& q_s) {
  for (std::size_t a = 0; a < axes_; ++a) {
    const double lower = lower_[a], upper = upper_[a];
    const double x = upper != lower ? ((q_s[a] + q_s[a]) - (lower + upper)) / (upper - lower) : 0.0;
    double* t = &chebyshev_[a * degrees_];
    t[0] = 1.0;
    t[1] = x;
    for (std::size_t d = 2; d < degrees_; ++d) t[d] = 2.0 * x * t[d - 1] - t[d - 2];
  }
}

const std::vector<double>& PostureInertia::at(const std::vector<double>& q_s) {
  if (q_s == q_s_) return matrix_;  // the tick before asked for it
  q_s_ = q_s;
  fillChebyshev(q_s);
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  for (const Term& term : terms_) {
    double product = 1.0;
    for (const std::size_t factor : term.factors) product *= chebyshev_[factor];
    for (const auto& [k, coefficient] : term.coefficients) matrix_[k] += product * coefficient;
  }
  return matrix_;
}

void PostureInertia::solve(std::vector<double>& a, std::size_t known) {
  factor_ = matrix_;
  for (std::size_t j = known; j < axes_; ++j) {
    for (std::size_t i = j; i < axes_; ++i) {
      double sum = factor_[place(i, j)];
      for (std::size_t k = known; k < j; ++k) {
        sum -= factor_[place(i, k)] * factor_[place(j, k)] * factor_[place(k, k)];
      }
      factor_[place(i, j)] = i == j ? sum : sum / factor_[place(j, j)];
    }
  }
  // The columns of what is known are M's own.
  for (std::size_t i = known; i < axes_; ++i) {
    for (std::size_t k = 0; k < i; ++k) a[i] -= factor_[place(i, k)] * a[k];
  }
  for (std::size_t i = known; i < axes_; ++i) a[i] /= factor_[place(i, i)];
  for (std::size_t i = axes_; i-- > known;) {
    for (std::size_t k = i + 1; k < axes_; ++k) a[i] -= factor_[place(k, i)] * a[k];
  }
}

}  // namespace wholehand::recording
