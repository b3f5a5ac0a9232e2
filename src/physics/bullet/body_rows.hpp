#pragma once

#include "physics/bullet/row_arithmetic.hpp"

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>

#include <array>
#include <vector>

namespace wholehand::bullet {

/// Rows of the contacts between two bodies, as Bullet's solver has set them up. Projected
/// Gauss-Seidel sweeps four contacts at once, to the same bits as Bullet's own sweep: contacts that
/// share a movable body keep their order, and four that share none form a group. Real-time safe
/// except for construction.
class BodyRows {
 public:
  using Bodies = btAlignedObjectArray<btSolverBody>;

  /// @param contacts, bodies most of them
  BodyRows(int contacts, int bodies);

  /// Copies a step's rows. @pre no more contacts and bodies than room, two rows of friction per
  /// contact, no compliance @param touched per body: the hand changes its velocity between sweeps,
  /// and its contacts are near
  void read(const btConstraintArray& normals, const btConstraintArray& frictions,
            const Bodies& bodies, const std::vector<bool>& touched) noexcept;
  [[nodiscard]] bool any() const noexcept { return !all_.empty(); }
  [[nodiscard]] bool anyNear() const noexcept { return !near_.empty(); }
  /// One sweep: all normals, then all friction. Takes the velocities of touched bodies from
  /// `bodies`, and puts them there. @return largest change of an impulse [N·s]
  [[nodiscard]] double sweepAll(Bodies& bodies) noexcept;
  /// The same over near contacts only.
  [[nodiscard]] double sweepNear(Bodies& bodies) noexcept;
  /// Writes back impulses, and velocities of bodies that are not touched. @pre the arrays of read()
  void write(btConstraintArray& normals, btConstraintArray& frictions,
             Bodies& bodies) const noexcept;

 private:
  static constexpr int kWide = 4;
  /// Change of a body's velocity in this step.
  struct alignas(64) Motion {
    std::array<double, 4> linear{}, angular{};  ///< the last one zero
  };
  /// A number, and a vector, of each contact of a group.
  using Each = std::array<double, kWide>;
  using EachVector = std::array<Each, 3>;
  struct alignas(32) Row {
    EachVector along;  ///< direction of the impulse on the first body; the second has the opposite
    EachVector about_a, about_b;        ///< its torque per impulse
    EachVector response_a, response_b;  ///< change of the angular velocity per impulse
    Each target;                        ///< impulse that alone would reach the target velocity
    Each effective_mass;
    Each impulse;
  };
  struct alignas(32) Group {
    Row normal, tangent1, tangent2;
    Each inverse_mass_a, inverse_mass_b, friction;
    std::array<Motion*, kWide> a, b;
    std::array<int, kWide> contact;  ///< in Bullet's array; -1: the place is empty
  };
  struct Velocities;

  int sortIntoRuns(const btConstraintArray& normals, const Bodies& bodies,
                   const std::vector<bool>& touched) noexcept;
  void leaveEmpty(Group& group, int place) noexcept;
  static void copy(const btSolverConstraint& from, bool a_moves, Row& to, int place) noexcept;
  [[gnu::always_inline]] static inline void press(Group& group, FourNumbers& most);
  [[gnu::always_inline]] static inline void rub(Row& row, const Group& group,
                                                const FourNumbers& normal, Velocities& velocities,
                                                FourNumbers& most);
  [[nodiscard]] double sweep(Bodies& bodies, const std::vector<Group*>& groups) noexcept;
  [[nodiscard]] static double sweep(const std::vector<Group*>& groups) noexcept;

  std::vector<Group> groups_;        ///< fixed size
  std::vector<Group*> all_, near_;   ///< in the order of sweeps
  std::vector<Motion> motions_;      ///< per body; the last one of no body
  std::vector<int> touched_, free_;  ///< movable bodies
  std::vector<int> depth_;           ///< per body: of its next contact
  std::vector<int> run_;             ///< per contact, in Bullet's order
  std::vector<int> place_;           ///< per run: of its next contact; four places a group
  int runs_ = 0;
};

}  // namespace wholehand::bullet
