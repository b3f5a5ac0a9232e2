#include "telemetry/posture_inertia.hpp"

#include <algorithm>

namespace wholehand::recording {

PostureInertia::PostureInertia(const RecordedInertia& inertia, std::size_t axes)
    : inertia_(inertia), axes_(axes), terms_(inertia.degrees.size() / axes), degrees_(2) {
  for (const double degree : inertia_.degrees) {
    degree_.push_back(static_cast<std::size_t>(degree));
    degrees_ = std::max(degrees_, degree_.back() + 1);
  }
  chebyshev_.resize(axes_ * degrees_);
}

// Chebyshev polynomials of each axis, whose range is -1 .. 1.
void PostureInertia::fillChebyshev(const std::vector<double>& q_s) {
  for (std::size_t a = 0; a < axes_; ++a) {
    const double lower = inertia_.lower[a], upper = inertia_.upper[a];
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
  const std::size_t size = axes_ * (axes_ + 1) / 2;
  matrix_.assign(size, 0.0);
  for (std::size_t t = 0; t < terms_; ++t) {
    double product = 1.0;
    for (std::size_t a = 0; a < axes_; ++a) {
      const std::size_t degree = degree_[t * axes_ + a];
      if (degree > 0) product *= chebyshev_[a * degrees_ + degree];
    }
    const double* coefficient = &inertia_.coefficients[t * size];
    for (std::size_t k = 0; k < size; ++k) matrix_[k] += product * coefficient[k];
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
