#include "loop/physics/bullet/island_newton.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

// Newton's method with limits of friction that follow their normal impulses. Its fixed points are
// those of the solutions with given limits, which approach them slowly where friction tips a body,
// or not at all.

namespace wholehand::bullet {
namespace {

constexpr double kCoupledSoftness = 1e-4;  // R of a row divided by its mobility
constexpr int kMostCoupledUpdates = 20;    // of x₀
constexpr int kMostCoupledSteps = 12;      // Newton steps in one of them
constexpr double kCoupled = 1e-10;         // tolerance of w, relative to the largest impulse
constexpr double kCoupledImpulse = 1e-8, kCoupledVelocity = 1e-8;

}  // namespace

// Computes a contact's impulses; the limit of friction follows the normal impulse.
void IslandNewton::projectCoupled(Contact& c) noexcept {
  if (c.spins >= 0) {
    c.limit = c.box = c.spin_m * std::max(0.0, contacts_[c.spins].free[0]);
  } else if (!c.of_joint) {
    c.limit = c.friction * std::max(0.0, c.free[0]);
  }
  project(c);
}

void IslandNewton::addCoupled(const Contact& c, const Six& rows_a, const Six& rows_b,
                              const Six& columns_a, const Six& columns_b, double weight) noexcept {
  if (c.a >= 0) addProduct(diagonal_[c.a], rows_a, columns_a, weight);
  if (c.b >= 0) addProduct(diagonal_[c.b], rows_b, columns_b, weight);
  if (c.a < 0 || c.b < 0) return;
  if (place_[c.a] < place_[c.b]) {
    addProduct(blockOf(c.a, c.b), rows_b, columns_a, weight);
    addProduct(upperOf(c.a, c.b), rows_a, columns_b, weight);
  } else {
    addProduct(blockOf(c.b, c.a), rows_a, columns_b, weight);
    addProduct(upperOf(c.b, c.a), rows_b, columns_a, weight);
  }
}

void IslandNewton::assembleCoupled() noexcept {
  for (int k = 0; k < body_count_; ++k) {
    diagonal_[k].fill(0.0);
    for (int i = 0; i < kSize; ++i) diagonal_[k][(kSize + 1) * i] = 1.0;
  }
  for (int i = 0; i < block_count_; ++i) {
    blocks_[i].fill(0.0);
    upper_[i].fill(0.0);
  }
  for (int i = 0; i < contact_count_; ++i) {
    const Contact& c = contacts_[i];
    const auto add = [&](const Six& a, const Six& b, double weight) {
      addCoupled(c, a, b, a, b, weight);
    };
    if (c.presses) add(c.along_a[0], c.along_b[0], c.inverse_softness[0]);
    if (c.sticks) {
      for (int r = 1; r < 3; ++r) add(c.along_a[r], c.along_b[r], c.inverse_softness[r]);
      continue;
    }
    Six a{}, b{};
    addScaled(a, -c.along2, c.along_a[1]), addScaled(a, c.along1, c.along_a[2]);
    addScaled(b, -c.along2, c.along_b[1]), addScaled(b, c.along1, c.along_b[2]);
    if (c.turning > 0.0) add(a, b, c.turning * c.inverse_softness[1]);
    // The limit moves with the normal impulse that sets it.
    const Contact& of = c.spins >= 0 ? contacts_[c.spins] : c;
    const double share = c.spins >= 0 ? c.spin_m : c.of_joint ? 0.0 : c.friction;
    if (!of.presses || share == 0.0) continue;
    Six along_a{}, along_b{};
    addScaled(along_a, c.along1, c.along_a[1]), addScaled(along_a, c.along2, c.along_a[2]);
    addScaled(along_b, c.along1, c.along_b[1]), addScaled(along_b, c.along2, c.along_b[2]);
    addCoupled(c, along_a, along_b, of.along_a[0], of.along_b[0], share * of.inverse_softness[0]);
  }
}

namespace {

/// Inverts a block by Gauss and Jordan. @return false: singular
bool invert(std::array<double, IslandNewton::kSize * IslandNewton::kSize>& m) {
  constexpr int kN = IslandNewton::kSize;
  std::array<double, kN * kN> inverse{};
  for (int i = 0; i < kN; ++i) inverse[(kN + 1) * i] = 1.0;
  for (int c = 0; c < kN; ++c) {
    int best = c;
    for (int r = c + 1; r < kN; ++r) {
      if (std::abs(m[kN * r + c]) > std::abs(m[kN * best + c])) best = r;
    }
    const double pivot = m[kN * best + c];
    if (!(std::abs(pivot) > 0.0)) return false;  // also for NaN
    for (int k = 0; k < kN; ++k) {
      std::swap(m[kN * best + k], m[kN * c + k]);
      std::swap(inverse[kN * best + k], inverse[kN * c + k]);
    }
    for (int k = 0; k < kN; ++k) m[kN * c + k] /= pivot, inverse[kN * c + k] /= pivot;
    for (int r = 0; r < kN; ++r) {
      const double factor = m[kN * r + c];
      if (r == c || factor == 0.0) continue;
      for (int k = 0; k < kN; ++k) {
        m[kN * r + k] -= factor * m[kN * c + k];
        inverse[kN * r + k] -= factor * inverse[kN * c + k];
      }
    }
  }
  m = inverse;
  return true;
}

}  // namespace

// LU by blocks. A diagonal block becomes its inverse, a block below it A D⁻¹.
bool IslandNewton::factorizeCoupled() noexcept {
  assembleCoupled();
  steps_ += 2;  // it costs twice as much as Cholesky's
  for (int place = 0; place < body_count_; ++place) {
    const int k = order_[place];
    if (!invert(diagonal_[k])) return false;
    for (std::uint32_t rest = later_[k]; rest != 0U; rest &= rest - 1U) {
      Block& b = blockOf(k, std::countr_zero(rest));
      const Block old = b;
      for (int r = 0; r < kSize; ++r) {
        for (int c = 0; c < kSize; ++c) {
          double sum = 0.0;
          for (int i = 0; i < kSize; ++i) sum += old[kSize * r + i] * diagonal_[k][kSize * i + c];
          b[kSize * r + c] = sum;
        }
      }
    }
    const auto subtract = [](Block& from, const Block& one, const Block& two) {
      for (int r = 0; r < kSize; ++r) {
        for (int i = 0; i < kSize; ++i) {
          const double factor = one[kSize * r + i];
          for (int c = 0; c < kSize; ++c) from[kSize * r + c] -= factor * two[kSize * i + c];
        }
      }
    };
    for (std::uint32_t rest = later_[k]; rest != 0U; rest &= rest - 1U) {
      const int i = std::countr_zero(rest);
      for (std::uint32_t more = later_[k]; more != 0U; more &= more - 1U) {
        const int j = std::countr_zero(more);
        Block& to = i == j ? diagonal_[i] : place_[i] < place_[j] ? upperOf(i, j) : blockOf(j, i);
        subtract(to, blockOf(k, i), upperOf(k, j));
      }
    }
  }
  return true;
}

void IslandNewton::solveCoupled() noexcept {
  for (int k = 0; k < body_count_; ++k) {
    for (int i = 0; i < kSize; ++i) step_[k][i] = -gradient_[k][i];
  }
  const auto subtract = [](Six& from, const Block& block, const Six& x) {
    for (int r = 0; r < kSize; ++r) {
      double sum = 0.0;
      for (int i = 0; i < kSize; ++i) sum += block[kSize * r + i] * x[i];
      from[r] -= sum;
    }
  };
  for (int place = 0; place < body_count_; ++place) {
    const int k = order_[place];
    for (std::uint32_t rest = later_[k]; rest != 0U; rest &= rest - 1U) {
      const int other = std::countr_zero(rest);
      subtract(step_[other], blockOf(k, other), step_[k]);
    }
  }
  for (int place = body_count_ - 1; place >= 0; --place) {
    const int k = order_[place];
    for (std::uint32_t rest = later_[k]; rest != 0U; rest &= rest - 1U) {
      const int other = std::countr_zero(rest);
      subtract(step_[k], upperOf(k, other), step_[other]);
    }
    Six x{};
    for (int r = 0; r < kSize; ++r) {
      for (int i = 0; i < kSize; ++i) x[r] += diagonal_[k][kSize * r + i] * step_[k][i];
    }
    step_[k] = x;
  }
}

// Newton's method with friction that follows its normal impulse, from a solution with given limits.
bool IslandNewton::couple(int most_steps, double fastest) noexcept {
  soften(kCoupledSoftness);
  for (int update = 0; update < kMostCoupledUpdates; ++update) {
    moveRows(change_, false);
    bool found = false;
    for (int step = 0; step < kMostCoupledSteps; ++step) {
      const double gradient = evaluate(true);
      found = gradient <= kCoupled * kCoupled * pressed_ + 1e-40;
      if (found) break;
      if (steps_ >= most_steps || !factorizeCoupled()) return false;
      solveCoupled();
      for (int k = 0; k < body_count_; ++k) addScaled(change_[k], 1.0, step_[k]);
      moveRows(change_, false);
    }
    if (!found) return false;
    double changed = 0.0, largest = 0.0, left = 0.0;
    for (int i = 0; i < contact_count_; ++i) {
      Contact& c = contacts_[i];
      largest = std::max(largest, c.impulse[0]);
      c.goal[0] -= c.gives * (c.impulse[0] - c.start[0]);
      const double presses = std::abs(c.impulse[0] - c.start[0]);
      const double turns = std::hypot(c.impulse[1] - c.start[1], c.impulse[2] - c.start[2]);
      if (c.yields > 0.0) changed = std::max({changed, presses, turns});
      if (c.inverse_softness[0] > 0.0) left = std::max(left, presses / c.inverse_softness[0]);
      if (c.inverse_softness[1] > 0.0) left = std::max(left, turns / c.inverse_softness[1]);
      c.start = c.impulse;
    }
    if (!std::isfinite(largest)) return false;
    if (changed <= kCoupledImpulse * largest + 1e-16 && left <= kCoupledVelocity * fastest) {
      return true;
    }
    if (update + 1 == kMostCoupledUpdates && left <= kExactVelocity * fastest) return true;
  }
  return false;
}

}  // namespace wholehand::bullet
