#include "dynamics/cholesky.hpp"

#include <array>
#include <cmath>

namespace wholehand {

namespace {

using Factor = std::array<std::array<double, kMaxAxes>, kMaxAxes>;

/// L with matrix = L Lᵀ; the diagonal holds 1 / L(j, j).
bool factor(const AxisMatrix& matrix, Factor& l) noexcept {
  const int n = static_cast<int>(matrix.rows());
  for (int j = 0; j < n; ++j) {
    double pivot = matrix(j, j);
    for (int k = 0; k < j; ++k) pivot -= l[j][k] * l[j][k];
    if (!(pivot > 0.0) || !std::isfinite(pivot)) return false;
    l[j][j] = 1.0 / std::sqrt(pivot);
    for (int i = j + 1; i < n; ++i) {
      double sum = matrix(i, j);
      for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = sum * l[j][j];
    }
  }
  return true;
}

/// L⁻¹, lower triangular, in place.
void invertFactor(Factor& l, int n) noexcept {
  for (int c = 0; c < n; ++c) {
    for (int i = c + 1; i < n; ++i) {
      double sum = 0.0;
      for (int k = c; k < i; ++k) sum += l[i][k] * l[k][c];
      l[i][c] = -sum * l[i][i];
    }
  }
}

}  // namespace

bool invertPositiveDefinite(const AxisMatrix& matrix, AxisMatrix& inverse) noexcept {
  const int n = static_cast<int>(matrix.rows());
  inverse.resize(n, n);
  Factor l;  // only the lower triangle is written and read
  if (!factor(matrix, l)) {
    inverse.setZero();
    return false;
  }
  invertFactor(l, n);
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      double sum = 0.0;
      for (int k = i; k < n; ++k) sum += l[k][i] * l[k][j];
      inverse(i, j) = sum;
      inverse(j, i) = sum;
    }
  }
  return true;
}

}  // namespace wholehand
