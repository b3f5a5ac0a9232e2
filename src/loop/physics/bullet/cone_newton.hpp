#pragma once

#include <array>
#include <cstdint>
#include <utility>

namespace wholehand::bullet {

/// Settings of ConeNewton; ADR 39 compares them.
struct NewtonSettings {
  double softness = 0.02;      ///< softness R of a row divided by its mobility
  double end_softness = 1e-4;  ///< the same for a cone of one row
  int most_steps = 12;         ///< factorisations in one solve
  int most_chords = 32;        ///< solutions of a linear system in one solve
  double tolerance = 1e-5;  ///< tolerance of an impulse, relative to the sum of the normal impulses
};

/// Finds the impulses of contacts that act on a few unknowns, by Newton's method. A cone is a
/// contact of one, three or four rows. One row: the normal, impulse ≥ 0; or a box, impulse within ±
/// limit. Three rows: the normal and two tangents, within the disc of friction · normal. Four rows:
/// also spin, within ± spin_m · normal.
///
/// The unknowns are velocities w in which the inertia is 1: w = Σ j x. The impulses x, each in its
/// cone, satisfy
///   x = P(y),  y = x₀ + (goal − j·w) / R,  R = softness |j|²
/// where x₀ are the impulses of the last step of the simulation. P is the projection onto the
/// cones, with the friction limits that the previous normal impulses set. P is piecewise linear: a
/// Newton step solves one symmetric system, and is exact once no contact changes between open and
/// closed, sticking and sliding, or spinning and not. When x₀ no longer changes, x is the limit of
/// projected Gauss-Seidel. When there are more rows than unknowns, R lets forces that cancel each
/// other change slowly from step to step, as sweeps do. A row that is blocked in part by a pressed
/// cone of one row (a joint's end) gets the R of its remaining mobility. Real-time safe.
class ConeNewton {
 public:
  static constexpr int kMostUnknowns = 48;
  static constexpr int kMostRows = 128;
  using Numbers = std::array<double, kMostUnknowns>;

  struct Row {
    alignas(32) Numbers along{};    ///< j
    double goal = 0.0;              ///< wanted velocity along the row minus the present one
    double start = 0.0;             ///< x₀
    double impulse = 0.0;           ///< x
    double mobility = 0.0;          ///< |j|²; 0: nothing moves along the row, and it is left out
    double inverse_softness = 0.0;  ///< 1 / R
    double free = 0.0;              ///< y
  };

  explicit ConeNewton(const NewtonSettings& settings) noexcept : settings_(settings) {}

  /// Removes all cones. @pre unknowns <= kMostUnknowns
  void begin(int unknowns) noexcept;
  /// Adds a cone of 1, 3 or 4 rows with `along` set to zero. @return its first row; null: no room
  [[nodiscard]] Row* add(int rows, double friction, double spin_m) noexcept;
  /// Adds a single row whose impulse is within ± limit, e.g. a joint's dry friction. @return the
  /// row; null: no room
  [[nodiscard]] Row* addBox(double limit) noexcept;
  /// Finds the impulses from the goals and starts of the rows. @return false when none were found
  [[nodiscard]] bool solve() noexcept;

  [[nodiscard]] int rowCount() const noexcept { return row_count_; }
  [[nodiscard]] const Row& row(int i) const noexcept { return rows_[i]; }
  /// Change of the unknowns: w = Σ j x.
  [[nodiscard]] const Numbers& change() const noexcept { return change_; }

 private:
  enum class Grip : std::uint8_t { kOpen, kSticks, kSlides };
  /// A cone, the piece of P to which the linear system belongs, and the piece into which its
  /// solution fell (next_...).
  struct Cone {
    int first = 0, rows = 1;
    double friction = 0.0, spin_m = 0.0;
    double box = 0.0;  ///< limit of a box; 0 for other cones
    Grip grip = Grip::kOpen, next_grip = Grip::kOpen;
    bool spins = false, next_spins = false;
    double along1 = 0.0, along2 = 0.0;  ///< direction of the friction of a sliding contact
    double turning = 0.0;  ///< change of that friction per change of y perpendicular to it
    double offset1 = 0.0, offset2 = 0.0;  ///< constant part of that friction
    double spin_offset = 0.0;
    alignas(32) Numbers across{};
  };
  struct Term {
    const double* along = nullptr;
    double weight = 0.0, offset = 0.0;
    alignas(32) Numbers weighted{};
  };

  bool solveNarrow() noexcept;
  bool solveWide() noexcept;
  bool solveWidest() noexcept;
  // V: number of vectors of four numbers that hold the unknowns.
  template <int V>
  bool solveWith() noexcept;
  template <int V>
  void startRows() noexcept;
  template <int V>
  void listEnds() noexcept;
  template <int V>
  void soften(const Cone& cone) noexcept;
  template <int V>
  void sweep() noexcept;
  template <int V>
  void set(Row& row, double impulse) noexcept;
  template <int V>
  [[nodiscard]] double wanted(const Row& row) const noexcept;
  template <int V>
  [[nodiscard]] double free(const Row& row) const noexcept;
  template <int V>
  void adopt(bool fresh) noexcept;
  template <int V>
  void adoptFriction(Cone& cone, bool fresh) noexcept;
  template <int V>
  void listTerms() noexcept;
  template <int V>
  void addTerm(const double* along, double weight, double offset) noexcept;
  template <int V, int Block>
  void sumBlock() noexcept;
  template <int V, int... Blocks>
  void sumBlocks(std::integer_sequence<int, Blocks...> blocks) noexcept;
  template <int V>
  bool factorize() noexcept;
  template <int V>
  void solveUnknowns() noexcept;
  template <int V>
  void project() noexcept;
  double projectFriction(Cone& cone) noexcept;
  double projectBox(Cone& cone) noexcept;
  template <int V>
  void sumChange() noexcept;

  const NewtonSettings settings_;
  int unknowns_ = 0, row_count_ = 0, cone_count_ = 0, term_count_ = 0;
  /// Largest difference between an impulse and the value that its piece gave.
  double misfit_ = 0.0;
  double pressed_ = 0.0;   ///< sum of the normal impulses
  bool moved_on_ = false;  ///< the solution fell into another piece
  std::array<Row, kMostRows> rows_;
  std::array<Cone, kMostRows> cones_;
  std::array<Term, kMostRows> terms_;
  static constexpr int kMostEnds = 8;  ///< further blocked directions are ignored
  int end_count_ = 0;
  /// Directions that pressed ends block; orthonormal.
  alignas(32) std::array<Numbers, kMostEnds> ends_{};
  alignas(32) Numbers change_{}, right_{};
  Numbers forward_{}, inverse_pivot_{};
  alignas(32) std::array<double, kMostUnknowns * kMostUnknowns> matrix_{};
};

}  // namespace wholehand::bullet
