#pragma once

#include "loop/physics/bullet/cone_newton.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"

#include <cmath>

// Steps that build and solve the linear system of a Newton step of ConeNewton. They are inlined
// into the functions that are compiled for two kinds of processors.

#define WHOLEHAND_INLINE [[gnu::always_inline]] inline

namespace wholehand::bullet {

template <int V>
WHOLEHAND_INLINE double dot(const double* a, const double* b, int first = 0) {
  FourNumbers x, y;
  load(x, a + 4 * first), load(y, b + 4 * first);
  FourNumbers sum = x * y;
  for (int v = first + 1; v < V; ++v) {
    load(x, a + 4 * v), load(y, b + 4 * v);
    sum += x * y;
  }
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/// Computes to -= factor · from, beginning with vector `first`.
template <int V>
WHOLEHAND_INLINE void subtract(double* to, double factor, const double* from, int first) {
  for (int v = first; v < V; ++v) {
    FourNumbers a, b;
    load(a, to + 4 * v), load(b, from + 4 * v);
    a -= factor * b;
    store(a, to + 4 * v);
  }
}

// Adopts the pieces of P into which the last solution fell. A chord step (fresh = false) keeps the
// data of which the matrix is made.
template <int V>
WHOLEHAND_INLINE void ConeNewton::adopt(bool fresh) noexcept {
  for (int c = 0; c < cone_count_; ++c) {
    Cone& cone = cones_[c];
    cone.grip = cone.next_grip;
    cone.spins = cone.next_spins;
    if (cone.box > 0.0) {
      cone.offset1 = rows_[cone.first].impulse;
      continue;
    }
    if (cone.grip == Grip::kSlides) adoptFriction<V>(cone, fresh);
    if (cone.rows == 4) cone.spin_offset = rows_[cone.first + 3].impulse;
  }
}

template <int V>
WHOLEHAND_INLINE void ConeNewton::adoptFriction(Cone& cone, bool fresh) noexcept {
  const Row& one = rows_[cone.first + 1];
  const Row& two = rows_[cone.first + 2];
  if (fresh) {
    const double length = std::sqrt(one.free * one.free + two.free * two.free);
    const double limit = std::sqrt(one.impulse * one.impulse + two.impulse * two.impulse);
    cone.along1 = length > 0.0 ? one.free / length : 1.0;
    cone.along2 = length > 0.0 ? two.free / length : 0.0;
    cone.turning = length > 0.0 ? limit / length : 0.0;
    cone.across.fill(0.0);
    addScaled<4 * V>(cone.across.data(), -cone.along2, one.along.data());
    addScaled<4 * V>(cone.across.data(), cone.along1, two.along.data());
  }
  const double across = cone.turning * (cone.along1 * two.free - cone.along2 * one.free);
  cone.offset1 = one.impulse + across * cone.along2;
  cone.offset2 = two.impulse - across * cone.along1;
}

template <int V>
WHOLEHAND_INLINE void ConeNewton::addTerm(const double* along, double weight,
                                          double offset) noexcept {
  Term& term = terms_[term_count_++];
  term.along = along;
  term.weight = weight;
  addScaled<4 * V>(right_.data(), offset, along);
}

// Lists the terms of the pieces' linear system: (1 + Σ weight along alongᵀ) w = Σ offset along.
template <int V>
WHOLEHAND_INLINE void ConeNewton::listTerms() noexcept {
  term_count_ = 0;
  right_.fill(0.0);
  const auto stick = [this](const Row& row) __attribute__((always_inline)) {
    if (row.mobility == 0.0) return;
    addTerm<V>(row.along.data(), row.inverse_softness, row.start + row.goal * row.inverse_softness);
  };
  for (int c = 0; c < cone_count_; ++c) {
    Cone& cone = cones_[c];
    if (cone.grip == Grip::kOpen) continue;
    const Row* rows = &rows_[cone.first];
    if (cone.box > 0.0 && cone.grip == Grip::kSlides) {
      addScaled<4 * V>(right_.data(), cone.offset1, rows[0].along.data());
      continue;
    }
    stick(rows[0]);
    if (cone.rows < 3) continue;
    if (cone.grip == Grip::kSlides) {
      addScaled<4 * V>(right_.data(), cone.offset1, rows[1].along.data());
      addScaled<4 * V>(right_.data(), cone.offset2, rows[2].along.data());
      const double weight = cone.turning * rows[1].inverse_softness;
      const double start = cone.along1 * rows[2].start - cone.along2 * rows[1].start;
      const double goal = cone.along1 * rows[2].goal - cone.along2 * rows[1].goal;
      addTerm<V>(cone.across.data(), weight, cone.turning * start + weight * goal);
    } else {
      stick(rows[1]);
      stick(rows[2]);
    }
    if (cone.rows < 4) continue;
    if (cone.spins) {
      addScaled<4 * V>(right_.data(), cone.spin_offset, rows[3].along.data());
    } else {
      stick(rows[3]);
    }
  }
}

/// Sums four rows of the matrix, from their diagonal on.
template <int V, int Block>
WHOLEHAND_INLINE void ConeNewton::sumBlock() noexcept {
  FourNumbers sum[4][V - Block] = {};
  for (int t = 0; t < term_count_; ++t) {
    const Term& term = terms_[t];
#pragma GCC unroll 8
    for (int v = 0; v < V - Block; ++v) {
      FourNumbers column;
      load(column, term.along + 4 * (Block + v));
#pragma GCC unroll 4
      for (int r = 0; r < 4; ++r) sum[r][v] += term.weighted[4 * Block + r] * column;
    }
  }
#pragma GCC unroll 4
  for (int r = 0; r < 4; ++r) {
    double* row = &matrix_[(4 * Block + r) * 4 * V];
#pragma GCC unroll 8
    for (int v = 0; v < V - Block; ++v) store(sum[r][v], row + 4 * (Block + v));
    row[4 * Block + r] += 1.0;
  }
}

template <int V, int... Blocks>
WHOLEHAND_INLINE void ConeNewton::sumBlocks(
    std::integer_sequence<int, Blocks...> /*blocks*/) noexcept {
  (sumBlock<V, Blocks>(), ...);
}

/// Sums the matrix and factorises it in place as Uᵀ D⁻¹ U, with D the diagonal of U.
template <int V>
WHOLEHAND_INLINE bool ConeNewton::factorize() noexcept {
  for (int t = 0; t < term_count_; ++t) {
    Term& term = terms_[t];
    for (int v = 0; v < V; ++v) {
      FourNumbers numbers;
      load(numbers, term.along + 4 * v);
      numbers *= term.weight;
      store(numbers, term.weighted.data() + 4 * v);
    }
  }
  sumBlocks<V>(std::make_integer_sequence<int, V>());
  for (int k = 0; k < unknowns_; ++k) {
    const double* pivot = &matrix_[k * 4 * V];
    if (!(pivot[k] > 0.0)) return false;  // also false for NaN
    inverse_pivot_[k] = 1.0 / pivot[k];
    for (int r = k + 1; r < unknowns_; ++r) {
      subtract<V>(&matrix_[r * 4 * V], pivot[r] * inverse_pivot_[k], pivot, r / 4);
    }
  }
  return true;
}

template <int V>
WHOLEHAND_INLINE void ConeNewton::solveUnknowns() noexcept {
  for (int k = 0; k < unknowns_; ++k) {
    forward_[k] = right_[k] * inverse_pivot_[k];
    subtract<V>(right_.data(), forward_[k], &matrix_[k * 4 * V], k / 4);
  }
  change_.fill(0.0);  // the matrix holds undefined numbers below the diagonal
  for (int k = unknowns_ - 1; k >= 0; --k) {
    const double later = dot<V>(&matrix_[k * 4 * V], change_.data(), k / 4);
    change_[k] = forward_[k] - later * inverse_pivot_[k];
  }
}

}  // namespace wholehand::bullet
