#include "loop/physics/bullet/cone_newton.hpp"

#include "loop/core/compiler.hpp"
#include "loop/physics/bullet/cone_newton_steps.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

// A row with a lower mobility moves nothing and is left out, e.g. a palm that spins on a fixed
// body.
constexpr double kLeastMobility = 1e-12;
// A chord step (which reuses the factorisation) must reduce the misfit to less than this share;
// otherwise the next step factorises again.
constexpr double kLeastGain = 0.3;
constexpr double kNothing_ns = 1e-12;  // absolute tolerance of an impulse
// Smallest share of a row's mobility that remains beside pressed ends.
constexpr double kLeastLeft = 1e-3;

}  // namespace

void ConeNewton::begin(int unknowns) noexcept {
  unknowns_ = unknowns;
  row_count_ = cone_count_ = 0;
}

ConeNewton::Row* ConeNewton::add(int rows, double friction, double spin_m) noexcept {
  if (row_count_ + rows > kMostRows) return nullptr;
  Cone& cone = cones_[cone_count_++];
  cone.first = row_count_;
  cone.rows = rows;
  cone.friction = friction;
  cone.spin_m = spin_m;
  cone.box = 0.0;
  cone.grip = Grip::kOpen;
  cone.spins = cone.next_spins = false;
  Row* added = &rows_[row_count_];
  for (int i = 0; i < rows; ++i) added[i].along.fill(0.0);
  row_count_ += rows;
  return added;
}

ConeNewton::Row* ConeNewton::addBox(double limit) noexcept {
  Row* added = add(1, 0.0, 0.0);
  if (added != nullptr) cones_[cone_count_ - 1].box = limit;
  return added;
}

// Lists the directions that pressed joint ends, and friction that holds a joint, block;
// orthonormal.
template <int V>
WHOLEHAND_INLINE void ConeNewton::listEnds() noexcept {
  end_count_ = 0;
  for (int c = 0; c < cone_count_ && end_count_ < kMostEnds; ++c) {
    const Cone& cone = cones_[c];
    const Row& row = rows_[cone.first];
    const bool hinders =
        cone.box > 0.0 ? row.start != 0.0 && std::abs(row.start) < cone.box : row.start > 0.0;
    if (cone.rows != 1 || !hinders) continue;
    double* end = ends_[end_count_].data();
    ends_[end_count_] = row.along;
    for (int k = 0; k < end_count_; ++k) {
      subtract<V>(end, dot<V>(ends_[k].data(), row.along.data()), ends_[k].data(), 0);
    }
    const double left = dot<V>(end, end);
    if (!(left > kLeastLeft * row.mobility)) continue;
    const double scale = 1.0 / std::sqrt(left);
    for (double& number : ends_[end_count_]) number *= scale;
    ++end_count_;
  }
}

template <int V>
WHOLEHAND_INLINE void ConeNewton::soften(const Cone& cone) noexcept {
  Row* rows = &rows_[cone.first];
  for (int i = 0; i < cone.rows; ++i) {
    double left = rows[i].mobility;
    for (int k = 0; k < end_count_ && cone.rows > 1; ++k) {
      const double hindered = dot<V>(ends_[k].data(), rows[i].along.data());
      left -= hindered * hindered;
    }
    left = std::max(left, kLeastLeft * rows[i].mobility);
    const double softness = cone.rows > 1 ? settings_.softness : settings_.end_softness;
    rows[i].inverse_softness = left > 0.0 ? 1.0 / (softness * left) : 0.0;
  }
  if (cone.rows < 3) return;
  // Both tangents have the same softness, because y is projected onto a disc.
  double& one = rows[1].inverse_softness;
  double& two = rows[2].inverse_softness;
  if (one > 0.0 && two > 0.0) one = two = std::min(one, two);
}

template <int V>
WHOLEHAND_INLINE void ConeNewton::startRows() noexcept {
  for (int i = 0; i < row_count_; ++i) {
    Row& row = rows_[i];
    row.mobility = dot<V>(row.along.data(), row.along.data());
    if (!(row.mobility > kLeastMobility)) row.mobility = row.start = 0.0;
    row.impulse = row.start;
  }
  listEnds<V>();
  for (int c = 0; c < cone_count_; ++c) soften<V>(cones_[c]);
}

template <int V>
WHOLEHAND_INLINE void ConeNewton::sumChange() noexcept {
  change_.fill(0.0);
  for (int i = 0; i < row_count_; ++i) {
    if (rows_[i].impulse == 0.0) continue;
    addScaled<4 * V>(change_.data(), rows_[i].impulse, rows_[i].along.data());
  }
}

template <int V>
WHOLEHAND_INLINE double ConeNewton::wanted(const Row& row) const noexcept {
  if (row.mobility == 0.0) return 0.0;
  return row.impulse + (row.goal - dot<V>(row.along.data(), change_.data())) / row.mobility;
}

/// The number y of a row: its impulse before the projection.
template <int V>
WHOLEHAND_INLINE double ConeNewton::free(const Row& row) const noexcept {
  return row.start + (row.goal - dot<V>(row.along.data(), change_.data())) * row.inverse_softness;
}

template <int V>
WHOLEHAND_INLINE void ConeNewton::set(Row& row, double impulse) noexcept {
  const double more = impulse - row.impulse;
  row.impulse = row.free = impulse;
  if (more != 0.0) addScaled<4 * V>(change_.data(), more, row.along.data());
}

// Makes one sweep of projected Gauss-Seidel, which shows which contacts hold, stick and spin.
template <int V>
WHOLEHAND_INLINE void ConeNewton::sweep() noexcept {
  for (int c = 0; c < cone_count_; ++c) {
    Cone& cone = cones_[c];
    Row* rows = &rows_[cone.first];
    if (cone.box > 0.0) {
      const double most = cone.box, whole = wanted<V>(rows[0]);
      set<V>(rows[0], std::clamp(whole, -most, most));
      cone.next_grip = std::abs(whole) > most ? Grip::kSlides : Grip::kSticks;
      continue;
    }
    set<V>(rows[0], std::max(0.0, wanted<V>(rows[0])));
    const double normal = rows[0].impulse;
    cone.next_grip = normal > 0.0 ? Grip::kSticks : Grip::kOpen;
    if (cone.rows < 3) continue;
    if (normal == 0.0) {
      for (int i = 1; i < cone.rows; ++i) set<V>(rows[i], 0.0);
      continue;
    }
    double t1 = wanted<V>(rows[1]), t2 = wanted<V>(rows[2]);
    const double length = std::sqrt(t1 * t1 + t2 * t2);
    const double limit = cone.friction * normal;
    if (length > limit) {
      cone.next_grip = Grip::kSlides;
      t1 *= limit / length;
      t2 *= limit / length;
    }
    set<V>(rows[1], t1);
    set<V>(rows[2], t2);
    if (cone.rows < 4) continue;
    const double most = cone.spin_m * normal;
    const double spin = wanted<V>(rows[3]);
    cone.next_spins = std::abs(spin) > most;
    set<V>(rows[3], std::clamp(spin, -most, most));
  }
}

double ConeNewton::projectFriction(Cone& cone) noexcept {
  Row& one = rows_[cone.first + 1];
  Row& two = rows_[cone.first + 2];
  const double normal = rows_[cone.first].impulse;
  const double limit = cone.friction * normal;
  const double length = std::sqrt(one.free * one.free + two.free * two.free);
  double share = 1.0;
  if (length > limit) {
    share = limit / length;
    if (normal > 0.0) cone.next_grip = Grip::kSlides;
  }
  one.impulse = one.free * share;
  two.impulse = two.free * share;
  double linear1 = one.free, linear2 = two.free;
  if (cone.grip == Grip::kOpen) linear1 = linear2 = 0.0;
  if (cone.grip == Grip::kSlides) {
    const double across = cone.turning * (cone.along1 * two.free - cone.along2 * one.free);
    linear1 = cone.offset1 - across * cone.along2;
    linear2 = cone.offset2 + across * cone.along1;
  }
  double worst = std::max(std::abs(one.impulse - linear1), std::abs(two.impulse - linear2));
  if (cone.rows < 4) return worst;
  Row& spin = rows_[cone.first + 3];
  const double most = cone.spin_m * normal;
  cone.next_spins = std::abs(spin.free) > most;
  spin.impulse = std::clamp(spin.free, -most, most);
  const double linear = cone.grip == Grip::kOpen ? 0.0 : cone.spins ? cone.spin_offset : spin.free;
  return std::max(worst, std::abs(spin.impulse - linear));
}

double ConeNewton::projectBox(Cone& cone) noexcept {
  Row& row = rows_[cone.first];
  row.impulse = std::clamp(row.free, -cone.box, cone.box);
  cone.next_grip = row.impulse == row.free ? Grip::kSticks : Grip::kSlides;
  return std::abs(row.impulse - (cone.grip == Grip::kSlides ? cone.offset1 : row.free));
}

template <int V>
WHOLEHAND_INLINE void ConeNewton::project() noexcept {
  misfit_ = pressed_ = 0.0;
  moved_on_ = false;
  for (int c = 0; c < cone_count_; ++c) {
    Cone& cone = cones_[c];
    Row* rows = &rows_[cone.first];
    rows[0].free = free<V>(rows[0]);
    if (cone.box > 0.0) {
      misfit_ = std::max(misfit_, projectBox(cone));
      moved_on_ |= cone.next_grip != cone.grip;
      continue;
    }
    const bool open = !(rows[0].free > 0.0);
    if (open && cone.grip == Grip::kOpen) continue;
    cone.next_grip = open ? Grip::kOpen : Grip::kSticks;
    rows[0].impulse = open ? 0.0 : rows[0].free;
    pressed_ += rows[0].impulse;
    for (int i = 1; i < cone.rows; ++i) rows[i].free = free<V>(rows[i]);
    if (open != (cone.grip == Grip::kOpen)) misfit_ = std::max(misfit_, std::abs(rows[0].free));
    if (cone.rows >= 3) misfit_ = std::max(misfit_, projectFriction(cone));
    if (open) cone.next_spins = cone.spins;
    moved_on_ |= cone.next_grip != cone.grip || cone.next_spins != cone.spins;
  }
}

template <int V>
WHOLEHAND_INLINE bool ConeNewton::solveWith() noexcept {
  startRows<V>();
  sumChange<V>();
  sweep<V>();
  bool fresh = true;  // true: the matrix does not belong to the present pieces
  double before = 0.0;
  int steps = 0;
  for (int chord = 0; chord < settings_.most_chords; ++chord) {
    adopt<V>(fresh);
    listTerms<V>();
    if (fresh && (steps == settings_.most_steps || !factorize<V>())) return false;
    if (fresh) ++steps;
    solveUnknowns<V>();
    project<V>();
    if (misfit_ <= settings_.tolerance * pressed_ + kNothing_ns) {
      sumChange<V>();
      return true;
    }
    fresh = moved_on_ || (!fresh && !(misfit_ < kLeastGain * before));
    before = misfit_;
  }
  return false;
}

WHOLEHAND_VECTOR_CLONES bool ConeNewton::solveNarrow() noexcept {
  return unknowns_ <= 8 ? solveWith<2>() : solveWith<3>();
}
WHOLEHAND_VECTOR_CLONES bool ConeNewton::solveWide() noexcept {
  return unknowns_ <= 16 ? solveWith<4>() : solveWith<6>();
}
WHOLEHAND_VECTOR_CLONES bool ConeNewton::solveWidest() noexcept {
  return solveWith<12>();
}

bool ConeNewton::solve() noexcept {
  if (unknowns_ <= 12) return solveNarrow();
  return unknowns_ <= 24 ? solveWide() : solveWidest();
}

}  // namespace wholehand::bullet
