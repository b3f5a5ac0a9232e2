#include "loop/physics/bullet/island_newton.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace wholehand::bullet {
namespace {

constexpr double kLeastMobility = 1e-12;  // nothing moves along a row of less [1/kg]
// Softness R of a row divided by its mobility, one after the other. The soft ones show which
// contacts hold and stick.
constexpr std::array kSoftness{1e-3, 1e-4, 1e-5, 1e-6};
// At the largest impulse a normal between bodies gives way by this share of the largest goal of
// one.
constexpr double kGives = 3e-6;
constexpr int kMostUpdates = 16;        // of x₀
constexpr int kMostChords = 40;         // Newton steps in one solution
constexpr double kExact = 1e-8;         // tolerance of w, relative to the largest impulse
constexpr double kExactImpulse = 1e-5;  // tolerance of an impulse, relative to the largest one
constexpr double kLeastGain = 0.3;      // a step that reuses a matrix must gain this much

}  // namespace

void IslandNewton::begin(int bodies) noexcept {
  body_count_ = bodies;
  contact_count_ = 0;
  std::fill_n(near_.begin(), bodies, 0U);
}

IslandNewton::Contact* IslandNewton::add(int a, int b) noexcept {
  if (contact_count_ == kMostContacts) return nullptr;
  Contact& contact = contacts_[contact_count_++];
  contact.a = a;
  contact.b = b;
  contact.of_joint = false;
  contact.friction = contact.box = contact.yields = 0.0;
  contact.spins = -1;
  contact.goal = contact.start = {};
  for (Six& six : contact.along_a) six.fill(0.0);
  for (Six& six : contact.along_b) six.fill(0.0);
  if (a >= 0 && b >= 0) {
    near_[a] |= 1U << static_cast<unsigned>(b);
    near_[b] |= 1U << static_cast<unsigned>(a);
  }
  return &contact;
}

// Minimum degree: eliminating a body makes its neighbours neighbours of each other.
int IslandNewton::order() noexcept {
  std::array<std::uint32_t, kMostBodies> graph = near_;
  std::uint32_t left = body_count_ == 32 ? ~0U : (1U << static_cast<unsigned>(body_count_)) - 1U;
  block_count_ = 0;
  int work = 0;
  for (int place = 0; place < body_count_; ++place) {
    int best = -1;
    for (int body = 0; body < body_count_; ++body) {
      if ((left >> static_cast<unsigned>(body) & 1U) == 0U) continue;
      if (best < 0 || std::popcount(graph[body]) < std::popcount(graph[best])) best = body;
    }
    left &= ~(1U << static_cast<unsigned>(best));
    order_[place] = best;
    place_[best] = place;
    later_[best] = graph[best];
    const int degree = std::popcount(graph[best]);
    work += 1 + degree + degree * (degree + 1) / 2;
    if (block_count_ + degree > kMostBlocks) return 0;
    for (std::uint32_t rest = graph[best]; rest != 0U; rest &= rest - 1U) {
      const int other = std::countr_zero(rest);
      block_[best][other] = static_cast<std::int16_t>(block_count_++);
      graph[other] |= graph[best];
      graph[other] &= ~(1U << static_cast<unsigned>(other) | 1U << static_cast<unsigned>(best));
    }
  }
  return work;
}

void IslandNewton::findMobilities() noexcept {
  for (int i = 0; i < contact_count_; ++i) {
    Contact& c = contacts_[i];
    for (int r = 0; r < 3; ++r) {
      c.mobility[r] = dot(c.along_a[r], c.along_a[r]) + dot(c.along_b[r], c.along_b[r]);
    }
    // Of both tangents the mean, which does not depend on how they lie in the plane of the contact.
    if (c.mobility[1] > kLeastMobility && c.mobility[2] > kLeastMobility) {
      c.mobility[1] = c.mobility[2] = 0.5 * (c.mobility[1] + c.mobility[2]);
    }
    for (int r = 0; r < 3; ++r) {
      if (!(c.mobility[r] > kLeastMobility)) c.mobility[r] = c.start[r] = 0.0;
    }
  }
}

void IslandNewton::soften(double softness) noexcept {
  for (int i = 0; i < contact_count_; ++i) {
    Contact& c = contacts_[i];
    for (int r = 0; r < 3; ++r) {
      const double stays = r == 0 ? c.gives : 0.0;
      c.inverse_softness[r] = c.mobility[r] > 0.0 ? 1.0 / (softness * c.mobility[r] + stays) : 0.0;
    }
  }
}

// Computes a contact's impulses from the numbers y.
void IslandNewton::project(Contact& c) noexcept {
  c.presses = c.free[0] > 0.0;
  c.impulse[0] = std::max(0.0, c.free[0]);
  const double length = std::sqrt(c.free[1] * c.free[1] + c.free[2] * c.free[2]);
  double share = 1.0;
  if (length > c.limit) {
    share = c.limit / length;
    if (c.limit > 0.0) {
      c.along1 = c.free[1] / length;
      c.along2 = c.free[2] / length;
    }
  }
  c.turning = share;
  c.sticks = share == 1.0;
  c.impulse[1] = share * c.free[1];
  c.impulse[2] = share * c.free[2];
}

// Velocities of all rows by unknowns.
void IslandNewton::moveRows(std::array<Six, kMostBodies>& by, bool of_step) noexcept {
  for (int i = 0; i < contact_count_; ++i) {
    Contact& c = contacts_[i];
    std::array<double, 3>& to = of_step ? c.moves : c.moved;
    for (int r = 0; r < 3; ++r) {
      double sum = 0.0;
      if (c.a >= 0) sum += dot(c.along_a[r], by[c.a]);
      if (c.b >= 0) sum += dot(c.along_b[r], by[c.b]);
      to[r] = sum;
    }
  }
}

// Computes the impulses and the gradient w − Σ j x at the present w. Coupled, limits of friction
// follow the normal impulses. @return the gradient's square
double IslandNewton::evaluate(bool coupled) noexcept {
  for (int k = 0; k < body_count_; ++k) gradient_[k] = change_[k];
  pressed_ = 0.0;
  for (int i = 0; i < contact_count_; ++i) {
    Contact& c = contacts_[i];
    for (int r = 0; r < 3; ++r) {
      c.free[r] = c.start[r] + (c.goal[r] - c.moved[r]) * c.inverse_softness[r];
    }
    coupled ? projectCoupled(c) : project(c);
    pressed_ = std::max(pressed_, c.impulse[0] * c.impulse[0] * c.mobility[0]);
    if (!coupled) {
      pressed_ = std::max(pressed_, c.impulse[1] * c.impulse[1] * c.mobility[1] +
                                        c.impulse[2] * c.impulse[2] * c.mobility[2]);
    }
    for (int r = 0; r < 3; ++r) {
      if (c.impulse[r] == 0.0) continue;
      if (c.a >= 0) addScaled(gradient_[c.a], -c.impulse[r], c.along_a[r]);
      if (c.b >= 0) addScaled(gradient_[c.b], -c.impulse[r], c.along_b[r]);
    }
  }
  double sum = 0.0;
  for (int k = 0; k < body_count_; ++k) sum += dot(gradient_[k], gradient_[k]);
  return sum;
}

// Slope of the convex function along the step, at a share of it.
double IslandNewton::slopeAt(double share) const noexcept {
  double slope = 0.0;
  for (int k = 0; k < body_count_; ++k) {
    slope += dot(change_[k], step_[k]) + share * dot(step_[k], step_[k]);
  }
  for (int i = 0; i < contact_count_; ++i) {
    const Contact& c = contacts_[i];
    std::array<double, 3> y{};
    for (int r = 0; r < 3; ++r) {
      y[r] = c.start[r] + (c.goal[r] - c.moved[r] - share * c.moves[r]) * c.inverse_softness[r];
    }
    if (y[0] > 0.0) slope -= y[0] * c.moves[0];
    const double length2 = y[1] * y[1] + y[2] * y[2];
    const double within = length2 > c.limit * c.limit ? c.limit / std::sqrt(length2) : 1.0;
    slope -= within * (y[1] * c.moves[1] + y[2] * c.moves[2]);
  }
  return slope;
}

void IslandNewton::addTerm(const Contact& c, const Six& a, const Six& b, double weight) noexcept {
  if (c.a >= 0) addProduct(diagonal_[c.a], a, a, weight);
  if (c.b >= 0) addProduct(diagonal_[c.b], b, b, weight);
  if (c.a < 0 || c.b < 0) return;
  if (place_[c.a] < place_[c.b]) {
    addProduct(blockOf(c.a, c.b), b, a, weight);
  } else {
    addProduct(blockOf(c.b, c.a), a, b, weight);
  }
}

void IslandNewton::addProduct(Block& block, const Six& rows, const Six& columns,
                              double weight) noexcept {
  for (int r = 0; r < kSize; ++r) {
    const double factor = weight * rows[r];
    for (int k = 0; k < kSize; ++k) block[kSize * r + k] += factor * columns[k];
  }
}

void IslandNewton::assemble() noexcept {
  for (int k = 0; k < body_count_; ++k) {
    diagonal_[k].fill(0.0);
    for (int i = 0; i < kSize; ++i) diagonal_[k][(kSize + 1) * i] = 1.0;
  }
  for (int i = 0; i < block_count_; ++i) blocks_[i].fill(0.0);
  for (int i = 0; i < contact_count_; ++i) {
    Contact& c = contacts_[i];
    c.matrix_presses = c.presses;
    c.matrix_sticks = c.sticks;
    if (c.presses) addTerm(c, c.along_a[0], c.along_b[0], c.inverse_softness[0]);
    if (c.turning == 0.0) continue;
    if (c.sticks) {
      for (int r = 1; r < 3; ++r) addTerm(c, c.along_a[r], c.along_b[r], c.inverse_softness[r]);
      continue;
    }
    Six a{}, b{};
    addScaled(a, -c.along2, c.along_a[1]), addScaled(a, c.along1, c.along_a[2]);
    addScaled(b, -c.along2, c.along_b[1]), addScaled(b, c.along1, c.along_b[2]);
    addTerm(c, a, b, c.turning * c.inverse_softness[1]);
  }
}

// Cholesky by blocks. A diagonal block becomes its lower root with the inverse of its diagonal; a
// block below it becomes B = A L⁻ᵀ.
bool IslandNewton::factorize() noexcept {
  assemble();
  ++steps_;
  for (int place = 0; place < body_count_; ++place) {
    const int k = order_[place];
    Block& d = diagonal_[k];
    for (int c = 0; c < kSize; ++c) {
      double pivot = d[kSize * c + c];
      for (int i = 0; i < c; ++i) pivot -= d[kSize * c + i] * d[kSize * c + i];
      if (!(pivot > 0.0)) return false;  // also false for NaN
      const double inverse = 1.0 / std::sqrt(pivot);
      d[kSize * c + c] = inverse;
      for (int r = c + 1; r < kSize; ++r) {
        double sum = d[kSize * r + c];
        for (int i = 0; i < c; ++i) sum -= d[kSize * r + i] * d[kSize * c + i];
        d[kSize * r + c] = sum * inverse;
      }
    }
    for (std::uint32_t rest = later_[k]; rest != 0U; rest &= rest - 1U) {
      Block& b = blockOf(k, std::countr_zero(rest));
      for (int r = 0; r < kSize; ++r) {
        for (int c = 0; c < kSize; ++c) {
          double sum = b[kSize * r + c];
          for (int i = 0; i < c; ++i) sum -= b[kSize * r + i] * d[kSize * c + i];
          b[kSize * r + c] = sum * d[kSize * c + c];
        }
      }
    }
    const auto subtract = [](Block& from, const Block& one, const Block& two) {
      for (int r = 0; r < kSize; ++r) {
        for (int c = 0; c < kSize; ++c) {
          double sum = 0.0;
          for (int i = 0; i < kSize; ++i) sum += one[kSize * r + i] * two[kSize * c + i];
          from[kSize * r + c] -= sum;
        }
      }
    };
    for (std::uint32_t rest = later_[k]; rest != 0U; rest &= rest - 1U) {
      const int i = std::countr_zero(rest);
      const Block& of_i = blockOf(k, i);
      subtract(diagonal_[i], of_i, of_i);
      for (std::uint32_t more = rest & (rest - 1U); more != 0U; more &= more - 1U) {
        const int j = std::countr_zero(more);
        const Block& of_j = blockOf(k, j);
        if (place_[i] < place_[j]) {
          subtract(blockOf(i, j), of_j, of_i);
        } else {
          subtract(blockOf(j, i), of_i, of_j);
        }
      }
    }
  }
  factored_ = true;
  return true;
}

// Solves the matrix times the step = −gradient.
void IslandNewton::solveStep() noexcept {
  for (int k = 0; k < body_count_; ++k) {
    for (int i = 0; i < kSize; ++i) step_[k][i] = -gradient_[k][i];
  }
  for (int place = 0; place < body_count_; ++place) {
    const int k = order_[place];
    const Block& d = diagonal_[k];
    Six& x = step_[k];
    for (int r = 0; r < kSize; ++r) {
      for (int i = 0; i < r; ++i) x[r] -= d[kSize * r + i] * x[i];
      x[r] *= d[kSize * r + r];
    }
    for (std::uint32_t rest = later_[k]; rest != 0U; rest &= rest - 1U) {
      const int other = std::countr_zero(rest);
      const Block& b = blockOf(k, other);
      for (int r = 0; r < kSize; ++r) {
        double sum = 0.0;
        for (int i = 0; i < kSize; ++i) sum += b[kSize * r + i] * x[i];
        step_[other][r] -= sum;
      }
    }
  }
  for (int place = body_count_ - 1; place >= 0; --place) {
    const int k = order_[place];
    const Block& d = diagonal_[k];
    Six& x = step_[k];
    for (std::uint32_t rest = later_[k]; rest != 0U; rest &= rest - 1U) {
      const int other = std::countr_zero(rest);
      const Block& b = blockOf(k, other);
      for (int r = 0; r < kSize; ++r) {
        for (int i = 0; i < kSize; ++i) x[i] -= b[kSize * r + i] * step_[other][r];
      }
    }
    for (int r = kSize - 1; r >= 0; --r) {
      for (int i = r + 1; i < kSize; ++i) x[r] -= d[kSize * i + r] * x[i];
      x[r] *= d[kSize * r + r];
    }
  }
}

bool IslandNewton::piecesChanged() const noexcept {
  for (int i = 0; i < contact_count_; ++i) {
    const Contact& c = contacts_[i];
    if (c.presses != c.matrix_presses || c.sticks != c.matrix_sticks) return true;
  }
  return false;
}

// Minimises the convex function of w for the present x₀ and friction limits.
bool IslandNewton::minimise(int most_steps) noexcept {
  moveRows(change_, false);
  double before = 0.0;
  if (again_) {
    // The pieces of the last solution are still in presses, sticks, along and turning.
    if (!factored_ && (steps_ == most_steps || !factorize())) return false;
    for (int k = 0; k < body_count_; ++k) gradient_[k] = change_[k];
    for (int i = 0; i < contact_count_; ++i) {
      const Contact& c = contacts_[i];
      std::array<double, 3> x{};
      for (int r = 0; r < 3; ++r) {
        x[r] = c.start[r] + (c.goal[r] - c.moved[r]) * c.inverse_softness[r];
      }
      if (!c.presses) x[0] = 0.0;
      if (!c.sticks) {
        const double across = c.turning * (c.along1 * x[2] - c.along2 * x[1]);
        x[1] = c.limit * c.along1 - across * c.along2;
        x[2] = c.limit * c.along2 + across * c.along1;
      }
      for (int r = 0; r < 3; ++r) {
        if (x[r] == 0.0) continue;
        if (c.a >= 0) addScaled(gradient_[c.a], -x[r], c.along_a[r]);
        if (c.b >= 0) addScaled(gradient_[c.b], -x[r], c.along_b[r]);
      }
    }
    solveStep();
    const std::array<Six, kMostBodies> step = step_;
    const double here = evaluate(false);
    moveRows(step_, true);
    for (int i = 0; i < contact_count_; ++i) {
      for (int r = 0; r < 3; ++r) contacts_[i].moved[r] += contacts_[i].moves[r];
    }
    for (int k = 0; k < body_count_; ++k) addScaled(change_[k], 1.0, step[k]);
    if (!(evaluate(false) < here)) {
      for (int k = 0; k < body_count_; ++k) addScaled(change_[k], -1.0, step[k]);
      moveRows(change_, false);
    }
  }
  bool fresh = !factored_;
  for (int chord = 0; chord < kMostChords; ++chord) {
    const double gradient = evaluate(false);
    if (gradient <= kExact * kExact * pressed_ + 1e-40) return true;
    if (chord > 0 && !(gradient < kLeastGain * kLeastGain * before)) fresh = true;
    if (chord == 0 && factored_ && piecesChanged()) fresh = true;
    before = gradient;
    if (fresh) {
      if (steps_ == most_steps || !factorize()) return false;
      fresh = false;
    }
    solveStep();
    moveRows(step_, true);
    // The slope rises along the step. A share with a slope near zero is taken.
    double share = 1.0;
    const double start = slopeAt(0.0);
    double end = slopeAt(1.0);
    if (!(start < 0.0)) return gradient <= 1e-12 * pressed_;
    if (end > -0.1 * start) {
      double low = 0.0, high = 1.0, low_slope = start, high_slope = end;
      for (int i = 0; i < 20 && std::abs(end) > -0.1 * start; ++i) {
        share = low + (high - low) * std::clamp(low_slope / (low_slope - high_slope), 0.1, 0.9);
        end = slopeAt(share);
        (end > 0.0 ? high : low) = share;
        (end > 0.0 ? high_slope : low_slope) = end;
      }
    }
    for (int k = 0; k < body_count_; ++k) addScaled(change_[k], share, step_[k]);
    for (int i = 0; i < contact_count_; ++i) {
      Contact& c = contacts_[i];
      for (int r = 0; r < 3; ++r) c.moved[r] += share * c.moves[r];
    }
  }
  return false;
}

// Softness of the normals between bodies. Where more points bear than are needed, it shares the
// load among them; without it their last impulses and the last digits of their gaps do (ADR 93).
double IslandNewton::sharing(double approach, double least_impulse) const noexcept {
  double largest = least_impulse;
  for (int i = 0; i < contact_count_; ++i) {
    if (!contacts_[i].of_joint) largest = std::max(largest, contacts_[i].impulse[0]);
  }
  return largest > 0.0 ? kGives * approach / largest : 0.0;
}

// Returns to the last solution with given limits.
void IslandNewton::restore() noexcept {
  change_ = kept_;
  for (int i = 0; i < contact_count_; ++i) contacts_[i].impulse = contacts_[i].kept;
}

bool IslandNewton::solve(int most_steps, int most_coupled_steps) noexcept {
  steps_ = 0;
  factored_ = again_ = false;
  findMobilities();
  // Largest goal of a normal, and the largest impulse that one alone would need for it.
  double approach = 0.0, alone = 0.0;
  for (int i = 0; i < contact_count_; ++i) {
    Contact& c = contacts_[i];
    c.start[0] = std::max(0.0, c.start[0]);
    c.impulse[0] = c.start[0];
    if (c.of_joint || !(c.mobility[0] > 0.0)) continue;
    approach = std::max(approach, c.goal[0]);
    alone = std::max(alone, c.goal[0] / c.mobility[0]);
  }
  double shares = sharing(approach, alone), fastest = 0.0;
  bool with_hand = false;
  for (int k = 0; k < body_count_; ++k) change_[k].fill(0.0);
  for (int i = 0; i < contact_count_; ++i) {
    Contact& c = contacts_[i];
    with_hand = with_hand || c.yields > 0.0;
    c.gives = c.of_joint || c.yields > 0.0 ? c.yields : shares;
    c.limit = limitOf(c, c.start[0]);
    // With this goal an impulse x that no longer changes satisfies j w + gives x = goal.
    c.goal[0] -= c.gives * c.start[0];
    if (!c.of_joint) {
      fastest = std::max({fastest, std::abs(c.goal[0]), std::hypot(c.goal[1], c.goal[2])});
    }
    for (int r = 0; r < 3; ++r) {
      if (c.a >= 0) addScaled(change_[c.a], c.start[r], c.along_a[r]);
      if (c.b >= 0) addScaled(change_[c.b], c.start[r], c.along_b[r]);
    }
  }
  soften(kSoftness.front());
  for (int update = 0; update < kMostUpdates; ++update) {
    if (!minimise(most_steps)) {
      if (update == 0) return false;
      restore();
      return true;
    }
    again_ = true;
    kept_ = change_;
    shares = sharing(approach, alone);
    double changed = 0.0, largest = 0.0, left = 0.0;
    for (int i = 0; i < contact_count_; ++i) {
      Contact& c = contacts_[i];
      largest = std::max(largest, c.impulse[0]);
      if (c.spins >= 0) c.box = c.spin_m * contacts_[c.spins].impulse[0];
      const double gives = c.of_joint || c.yields > 0.0 ? c.yields : shares;
      c.goal[0] -= gives * c.impulse[0] - c.gives * c.start[0];
      c.gives = gives;
      const double limit = limitOf(c, c.impulse[0]);
      changed = std::max(changed, std::abs(limit - c.limit));
      c.limit = limit;
      std::array<double, 3> moves{};
      for (int r = 0; r < 3; ++r) {
        if (c.inverse_softness[r] > 0.0) {
          moves[r] = (c.impulse[r] - c.start[r]) / c.inverse_softness[r];
        }
        c.start[r] = c.kept[r] = c.impulse[r];
      }
      left = std::max({left, std::abs(moves[0]), std::hypot(moves[1], moves[2])});
    }
    const bool still =
        changed <= kExactImpulse * largest + 1e-15 && left <= kExactVelocity * fastest;
    if (with_hand && update + 1 == static_cast<int>(kSoftness.size())) {
      if (!couple(most_coupled_steps, fastest)) restore();
      return true;
    }
    if (still && !with_hand) return true;
    if (update + 1 < static_cast<int>(kSoftness.size())) {
      soften(kSoftness[update + 1]);
      factored_ = false;
    }
  }
  return true;
}

}  // namespace wholehand::bullet
