#pragma once

#include <array>
#include <cstdint>

namespace wholehand::bullet {

/// Finds the impulses of the contacts of an island of bodies by Newton's method in the bodies'
/// velocities, with a block-sparse matrix (ADR 86).
///
/// Each body has six unknowns w in which its inertia is 1. A contact has a normal and two tangents
/// with rows j on two bodies. The impulses x, each in its cone, satisfy
///   w = Σ j x,  x = P(y),  y = x₀ + (goal − j·w) / R
/// P is the projection onto the cone, with the friction limit that the last normal impulse sets.
/// With given limits w minimises a convex function; a line search therefore makes every Newton step
/// decrease it. x then replaces x₀ until nothing changes (method of multipliers): the softness R
/// vanishes from the result. Bodies are eliminated in the order of fewest neighbours, equal ones in
/// their own order. If the hand is one of the bodies (a contact yields), Newton's method then lets
/// each limit follow its normal impulse: what is felt must not depend on when the multipliers stop.
/// Its matrix is not symmetric. If it finds nothing, the last solution with given limits stays. A
/// body on a joint uses one of its six unknowns; a cone of one body stands for its dry friction or
/// an end of its range. The hand may be one of the bodies. Real-time safe.
class IslandNewton {
 public:
  static constexpr int kMostBodies = 32, kMostContacts = 160, kMostBlocks = 320;
  static constexpr int kSize = 6;  ///< unknowns of a body
  using Six = std::array<double, kSize>;

  /// A contact; index 0 of each array is the normal, 1 and 2 are the tangents.
  struct Contact {
    int a = -1, b = -1;  ///< its bodies; -1: one that cannot move
    double friction = 0.0;
    bool of_joint = false;  ///< its rows are those of a joint, not of a contact
    double box = 0.0;     ///< of a joint: largest impulse of dry friction, along the first tangent
    double yields = 0.0;  ///< of the hand: softness of the normal [1/kg]
    /// A contact whose normal impulse sets the box: spin_m of it; -1: none.
    int spins = -1;
    double spin_m = 0.0;
    std::array<Six, 3> along_a{}, along_b{};
    std::array<double, 3> goal{};     ///< wanted velocity along a row minus the present one
    std::array<double, 3> start{};    ///< x₀
    std::array<double, 3> impulse{};  ///< x

    // Kept by solve(). The piece of P: the normal presses, the friction sticks; and that of the
    // matrix.
    bool presses = false, sticks = false, matrix_presses = false, matrix_sticks = false;
    std::array<double, 3> mobility{}, inverse_softness{}, free{}, moved{}, moves{};
    double limit = 0.0, gives = 0.0;  ///< softness of the normal that stays in the result [1/kg]
    std::array<double, 3> kept{};     ///< x of the last solution with given limits
    double along1 = 0.0, along2 = 0.0, turning = 0.0;  ///< direction of sliding friction
  };

  /// Removes all contacts. @pre bodies <= kMostBodies
  void begin(int bodies) noexcept;
  /// Adds a contact without mobility. @return null: no room
  [[nodiscard]] Contact* add(int a, int b) noexcept;
  /// Orders the bodies. @return the work of one factorisation, in products of blocks; 0: no room
  [[nodiscard]] int order() noexcept;
  /// Finds the impulses. @param most_steps factorisations with given limits @param
  /// most_coupled_steps factorisations altogether, if the hand is one of the bodies
  /// @return false: none were found
  [[nodiscard]] bool solve(int most_steps, int most_coupled_steps = 0) noexcept;

  [[nodiscard]] int contactCount() const noexcept { return contact_count_; }
  [[nodiscard]] const Contact& contact(int i) const noexcept { return contacts_[i]; }
  [[nodiscard]] Contact& contact(int i) noexcept { return contacts_[i]; }
  /// Change of a body's unknowns: w = Σ j x.
  [[nodiscard]] const Six& change(int body) const noexcept { return change_[body]; }
  /// Factorisations that solve() made.
  [[nodiscard]] int steps() const noexcept { return steps_; }

 private:
  using Block = std::array<double, kSize * kSize>;
  static constexpr double kExactVelocity = 1e-6;  ///< of a row, relative to the largest goal

  static double dot(const Six& a, const Six& b) noexcept {
    double sum = 0.0;
    for (int i = 0; i < kSize; ++i) sum += a[i] * b[i];
    return sum;
  }
  static void addScaled(Six& to, double factor, const Six& from) noexcept {
    for (int i = 0; i < kSize; ++i) to[i] += factor * from[i];
  }
  /// Limit of a contact's friction. @param normal impulse that sets it
  [[nodiscard]] static double limitOf(const Contact& contact, double normal) noexcept {
    return contact.of_joint ? contact.box : contact.friction * normal;
  }
  void findMobilities() noexcept;
  void soften(double softness) noexcept;
  void project(Contact& contact) noexcept;
  void moveRows(std::array<Six, kMostBodies>& by, bool of_step) noexcept;
  double evaluate(bool coupled) noexcept;
  [[nodiscard]] double slopeAt(double share) const noexcept;
  [[nodiscard]] bool piecesChanged() const noexcept;
  [[nodiscard]] double sharing(double approach, double least_impulse) const noexcept;
  void restore() noexcept;
  bool minimise(int most_steps) noexcept;
  [[nodiscard]] bool couple(int most_steps, double fastest) noexcept;
  void projectCoupled(Contact& contact) noexcept;
  void assembleCoupled() noexcept;
  void addCoupled(const Contact& contact, const Six& rows_a, const Six& rows_b,
                  const Six& columns_a, const Six& columns_b, double weight) noexcept;
  bool factorizeCoupled() noexcept;
  void solveCoupled() noexcept;
  void assemble() noexcept;
  void addTerm(const Contact& contact, const Six& a, const Six& b, double weight) noexcept;
  /// block += weight · rows columnsᵀ
  static void addProduct(Block& block, const Six& rows, const Six& columns, double weight) noexcept;
  bool factorize() noexcept;
  void solveStep() noexcept;
  [[nodiscard]] Block& blockOf(int earlier, int later) noexcept {
    return blocks_[block_[earlier][later]];
  }
  [[nodiscard]] Block& upperOf(int earlier, int later) noexcept {
    return upper_[block_[earlier][later]];
  }

  int body_count_ = 0, contact_count_ = 0, block_count_ = 0, steps_ = 0;
  bool factored_ = false, again_ = false;
  double pressed_ = 0.0;
  std::array<Contact, kMostContacts> contacts_;
  std::array<Six, kMostBodies> change_{}, gradient_{}, step_{}, kept_{};
  std::array<std::uint32_t, kMostBodies> near_{};  ///< per body: bits of its neighbours
  std::array<int, kMostBodies> order_{}, place_{};
  std::array<std::uint32_t, kMostBodies> later_{};  ///< neighbours eliminated later, with fill
  std::array<std::array<std::int16_t, kMostBodies>, kMostBodies> block_{};
  std::array<Block, kMostBlocks> blocks_{};
  std::array<Block, kMostBodies> diagonal_{};
  /// Above the diagonal, where the matrix is not symmetric: friction follows the normal.
  std::array<Block, kMostBlocks> upper_{};
};

}  // namespace wholehand::bullet
