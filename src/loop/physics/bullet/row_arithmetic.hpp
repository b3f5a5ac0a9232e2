#pragma once

#include "loop/core/four_numbers.hpp"

#include <array>
#include <cmath>

/// Arithmetic of solver rows, four numbers at once (loop/core/four_numbers.hpp).
namespace wholehand::bullet {

/// Velocity along a row: Σ j_a v_a over the axes, plus the products with two vectors of four
/// numbers. @tparam Width number of axes
template <int Width>
[[gnu::always_inline]] inline double alongRow(const double* jacobian, const double* change,
                                              const double* linear, const double* linear_velocity,
                                              const double* angular,
                                              const double* angular_velocity) {
  FourNumbers a, b, c, d;
  load(a, linear), load(b, linear_velocity);
  load(c, angular), load(d, angular_velocity);
  FourNumbers sum = a * b + c * d;
  for (int i = 0; i < Width; i += 4) {
    load(a, jacobian + i), load(b, change + i);
    sum += a * b;
  }
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/// Computes to += factor · response.
template <int Width>
[[gnu::always_inline]] inline void addScaled(double* to, double factor, const double* response) {
  for (int i = 0; i < Width; i += 4) {
    FourNumbers sum, more;
    load(sum, to + i), load(more, response + i);
    sum += factor * more;
    store(sum, to + i);
  }
}

/// Root L of an inverse inertia, M⁻¹ = L Lᵀ. In the velocities w with v = L w the inertia is 1.
/// @tparam Most largest size
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
  /// Computes Lᵀ j, which turns a row on v into a row on w.
  void transpose(const double* row, double* out) const noexcept {
    for (int c = 0; c < size_; ++c) out[c] = 0.0;
    for (int r = 0; r < size_; ++r) {
      const double* of_row = &root_[r * Most];
      const double factor = row[r];
      for (int c = 0; c <= r; ++c) out[c] += factor * of_row[c];
    }
  }
  /// Computes v = L w.
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

/// Coulomb's law at one contact: the friction impulse r stops the slip, or opposes it with the
/// largest impulse that the normal allows (maximum dissipation). Let A be the yield (slip per unit
/// of impulse) and b the slip that r must undo. Then r minimises ½ rᵀ A r − bᵀ r within the disc
/// |r| ≤ limit: (A + s 1) r = b with s = 0 inside; otherwise |r| = limit, and the slip −s r points
/// against r. This is the subproblem of a trust region (Moré, Sorensen 1983): Newton's method on
/// 1/|r| finds s from below.
/// @tparam Number double, or a vector of them
template <class Number>
struct FrictionDisc {
  Number yield_11{}, yield_12{}, yield_22{};  ///< A, positive definite [1/kg]
  Number mass_11{}, mass_12{}, mass_22{};     ///< A⁻¹ [kg]
  Number limit{};                             ///< [N·s]

  /// @param was_1, was_2 impulse now @param lacking_1, lacking_2 change of slip that would stop it
  [[gnu::always_inline]] void solve(const Number& was_1, const Number& was_2,
                                    const Number& lacking_1, const Number& lacking_2, Number& is_1,
                                    Number& is_2) const {
    is_1 = was_1 + mass_11 * lacking_1 + mass_12 * lacking_2;
    is_2 = was_2 + mass_12 * lacking_1 + mass_22 * lacking_2;
    Number length2 = is_1 * is_1 + is_2 * is_2;
    const auto slides = length2 > limit * limit;
    if (!any(slides)) return;
    const Number b_1 = lacking_1 + yield_11 * was_1 + yield_12 * was_2;
    const Number b_2 = lacking_2 + yield_12 * was_1 + yield_22 * was_2;
    const Number least = Number{} + 1e-300;
    Number a = yield_11, d = yield_22, det = a * d - yield_12 * yield_12;
    Number r_1 = is_1, r_2 = is_2;
    const Number rim2 = limit > Number{} ? limit * limit * (1.0 + 1e-9) : Number{} + 1e300;
    for (int i = 0; i < kMostSteps; ++i) {
      const auto beyond = length2 > rim2;
      if (!any(beyond)) break;
      const Number power = (d * r_1 * r_1 - 2.0 * yield_12 * r_1 * r_2 + a * r_2 * r_2) / det;
      Number length = length2;
      takeRoot(length);
      const Number floor = 1e-9 * length + least;  // avoids dividing by a limit of almost zero
      const Number radius = limit > floor ? limit : floor;
      const Number ratio = length2 / (power > least ? power : least);
      const Number grow = beyond ? (length - radius) / radius * ratio : Number{};
      a += grow;
      d += grow;
      det = a * d - yield_12 * yield_12;
      r_1 = beyond ? (d * b_1 - yield_12 * b_2) / det : r_1;
      r_2 = beyond ? (a * b_2 - yield_12 * b_1) / det : r_2;
      length2 = r_1 * r_1 + r_2 * r_2;
    }
    // Scales r to the rim of the disc.
    Number length = length2 > least ? length2 : least;
    takeRoot(length);
    is_1 = slides ? r_1 * (limit / length) : is_1;
    is_2 = slides ? r_2 * (limit / length) : is_2;
  }

 private:
  /// Each step doubles the number of exact digits; two or three are usual.
  static constexpr int kMostSteps = 12;

  [[gnu::always_inline]] static bool any(bool which) { return which; }
  template <class Mask>
  [[gnu::always_inline]] static bool any(const Mask& which) {
    return ((which[0] | which[1]) | (which[2] | which[3])) != 0;
  }
  [[gnu::always_inline]] static void takeRoot(double& x) { x = std::sqrt(x); }
  template <class Vector>
  [[gnu::always_inline]] static void takeRoot(Vector& x) {
    for (int i = 0; i < 4; ++i) x[i] = std::sqrt(x[i]);
  }
};

}  // namespace wholehand::bullet
