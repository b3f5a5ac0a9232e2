#pragma once

#include <array>
#include <cstdint>
#include <utility>

namespace wholehand::bullet {

/// Settings of ConeNewton; ADR 39 compares them.
struct NewtonSettings {
  double softness = 0.02;      ///< R of a row per its mobility
  double end_softness = 1e-4;  ///< the same of a cone of one row
  int most_steps = 12;         ///< factorisations in one solve
  int most_chords = 32;        ///< solutions of a linear system in one solve
  double tolerance = 1e-5;     ///< of an impulse, per sum of the normal impulses
};

/// Finds the impulses of contacts that act on a few unknowns, by Newton's method. A cone is a
/// contact of one row (normal, impulse ≥ 0; or a box, impulse within ± limit), three (and two
/// tangents, within the disc of friction · normal) or four (and spin, within ± spin_m · normal).
/// The unknowns are velocities in which the inertia is 1: w = Σ j x. The impulses x, in their
/// cones, are those of
///   x = P(y),  y = x₀ + (goal − j·w) / R,  R = softness |j|²
/// for the impulses x₀ of the last step of the simulation. P is the projection onto the cones with
/// the limits of friction that the normal impulses before set. It is linear by pieces: a Newton
/// step solves one symmetric system, and is exact once no contact begins or ends to hold, stick or
/// spin. Where x₀ stays, x is what projected Gauss-Seidel tends to. Where the rows exceed the
/// unknowns, R lets the forces that cancel each other move slowly from step to step, as sweeps do.
/// A row that a pressed cone of one row (a joint's end) hinders has the R of the mobility that is
/// left to it. Real-time safe.
class ConeNewton {
 public:
  static constexpr int kMostUnknowns = 48;
  static constexpr int kMostRows = 128;
  using Numbers = std::array<double, kMostUnknowns>;

  struct Row {
    alignas(32) Numbers along{};    ///< j
    double goal = 0.0;              ///< velocity that is wanted along the row, less what is there
    double start = 0.0;             ///< x₀
    double impulse = 0.0;           ///< x
    double mobility = 0.0;          ///< |j|²; 0: nothing moves, the row is left out
    double inverse_softness = 0.0;  ///< 1 / R
    double free = 0.0;              ///< y
  };

  explicit ConeNewton(const NewtonSettings& settings) noexcept : settings_(settings) {}

  /// Removes all cones. @pre unknowns <= kMostUnknowns @param softness R of a row per its mobility
  /// @param most_steps factorisations until the next begin()
  void begin(int unknowns, double softness, int most_steps) noexcept;
  void begin(int unknowns) noexcept { begin(unknowns, settings_.softness, settings_.most_steps); }
  /// Adds a cone of 1, 3 or 4 rows, `along` of them zero. @return its first row; null: no room
  [[nodiscard]] Row* add(int rows, double friction, double spin_m) noexcept;
  /// Adds a row of its own whose impulse is within ± limit: a joint's dry friction. @return as
  /// add()
  [[nodiscard]] Row* addBox(double limit) noexcept;
  /// Finds the impulses from the goals and starts of the rows. @return false: none were found
  [[nodiscard]] bool solve() noexcept;
  /// The same with another softness, from the pieces of P that the last solution fell upon.
  [[nodiscard]] bool solveAgain(double softness) noexcept;

  [[nodiscard]] int rowCount() const noexcept { return row_count_; }
  [[nodiscard]] const Row& row(int i) const noexcept { return rows_[i]; }
  /// w = Σ j x
  [[nodiscard]] const Numbers& change() const noexcept { return change_; }
  /// Factorisations that are left.
  [[nodiscard]] int stepsLeft() const noexcept { return steps_left_; }

 private:
  enum class Grip : std::uint8_t { kOpen, kSticks, kSlides };
  /// The piece of P that a linear system stands for, and the one that its solution fell upon.
  struct Cone {
    int first = 0, rows = 1;
    double friction = 0.0, spin_m = 0.0;
    double box = 0.0;  ///< limit of a box; 0 of others
    Grip grip = Grip::kOpen, next_grip = Grip::kOpen;
    bool spins = false, next_spins = false;
    double along1 = 0.0, along2 = 0.0;    ///< direction of friction that slides
    double turning = 0.0;                 ///< its change per change of y across
    double offset1 = 0.0, offset2 = 0.0;  ///< rest of it
    double spin_offset = 0.0;
    alignas(32) Numbers across{};
  };
  struct Term {
    const double* along = nullptr;
    double weight = 0.0, offset = 0.0;
    alignas(32) Numbers weighted{};
  };

  bool solveOnce() noexcept;
  bool solveNarrow() noexcept;
  bool solveWide() noexcept;
  bool solveWidest() noexcept;
  // V vectors of four numbers hold the unknowns.
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
  double softness_ = 0.0;
  bool again_ = false;
  int unknowns_ = 0, row_count_ = 0, cone_count_ = 0, term_count_ = 0;
  int steps_left_ = 0;
  double misfit_ = 0.0;    ///< largest difference of an impulse and what its piece made of it
  double pressed_ = 0.0;   ///< sum of the normal impulses
  bool moved_on_ = false;  ///< the solution fell upon another piece
  std::array<Row, kMostRows> rows_;
  std::array<Cone, kMostRows> cones_;
  std::array<Term, kMostRows> terms_;
  static constexpr int kMostEnds = 8;
  int end_count_ = 0;
  alignas(32) std::array<Numbers, kMostEnds> ends_{};  ///< orthonormal: what pressed ends hinder
  alignas(32) Numbers change_{}, right_{};
  Numbers forward_{}, inverse_pivot_{};
  alignas(32) std::array<double, kMostUnknowns * kMostUnknowns> matrix_{};
};

}  // namespace wholehand::bullet
