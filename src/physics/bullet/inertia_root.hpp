#pragma once

#include <array>
#include <cmath>

namespace wholehand::bullet {

/// L with M⁻¹ = L Lᵀ: in the velocities w of v = L w the inertia is 1. @tparam Most largest size
template <int Most>
class InertiaRoot {
 public:
  /// @param inverse M⁻¹(row, column), positive semidefinite
  template <class Inverse>
  void factorize(const Inverse& inverse, int size) noexcept {
    size_ = size;
    for (int c = 0; c < size; ++c) {
      double pivot = inverse(c, c);
      for (int k = 0; k < c; ++k) pivot -= at(c, k) * at(c, k);
      at(c, c) = pivot > 0.0 ? std::sqrt(pivot) : 0.0;
      const double share = pivot > 0.0 ? 1.0 / at(c, c) : 0.0;
      for (int r = c + 1; r < size; ++r) {
        double sum = inverse(r, c);
        for (int k = 0; k < c; ++k) sum -= at(r, k) * at(c, k);
        at(r, c) = sum * share;
      }
    }
  }
  /// Lᵀ j: a row on v, as one on w.
  void transpose(const double* row, double* out) const noexcept {
    for (int c = 0; c < size_; ++c) out[c] = 0.0;
    for (int r = 0; r < size_; ++r) {
      const double* of_row = &root_[r * Most];
      const double factor = row[r];
      for (int c = 0; c <= r; ++c) out[c] += factor * of_row[c];
    }
  }
  /// v = L w
  void apply(const double* w, double* v) const noexcept {
    for (int r = 0; r < size_; ++r) {
      double sum = 0.0;
      for (int c = 0; c <= r; ++c) sum += root_[r * Most + c] * w[c];
      v[r] = sum;
    }
  }

 private:
  double& at(int r, int c) noexcept { return root_[r * Most + c]; }

  int size_ = 0;
  std::array<double, Most * Most> root_{};  ///< rows; the upper triangle is not used
};

}  // namespace wholehand::bullet
