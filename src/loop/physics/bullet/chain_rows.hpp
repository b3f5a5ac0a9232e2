#pragma once

#include "loop/physics/bullet/cone_newton.hpp"
#include "loop/physics/bullet/island_newton.hpp"
#include "loop/physics/joint_chain.hpp"

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <array>
#include <vector>

namespace wholehand::bullet {

/// Constraint rows of trees of joints: dry friction, and the ends of their ranges, for each
/// coordinate. A tree is one body of the solver, that of its first link. The solver stores the
/// change of q̇ as the body's change of angular velocity and nothing else. Real-time safe except
/// for add().
class ChainRows {
 public:
  using Bodies = btAlignedObjectArray<btSolverBody>;

  /// Adds a tree. @param lead rigid body of its first link @pre both outlive this
  void add(btRigidBody& lead, JointChain& chain);
  [[nodiscard]] bool any() const noexcept { return !trees_.empty(); }

  // Each as the function of this name of JointRows, for the trees.
  void begin(std::vector<bool>& touched) noexcept;
  double solve(Bodies& bodies) noexcept;
  [[nodiscard]] bool addTo(ConeNewton& newton, int body, int unknown) noexcept;
  [[nodiscard]] bool addTo(IslandNewton& newton, int body, int slot) noexcept;
  void takeFrom(const ConeNewton& newton) noexcept;
  void takeFrom(const IslandNewton& newton, int body) noexcept;
  [[nodiscard]] bool endBears(const JointChain& chain, const btVector3& row) const noexcept;
  void release() noexcept;

 private:
  struct Coordinate {
    double friction = 0.0, end = 0.0;  ///< impulses of dry friction and of an end
  };
  struct Tree {
    btRigidBody* lead = nullptr;
    JointChain* chain = nullptr;
    int body = -1;  ///< index of the solver body in this step; -1: the tree rests
    std::array<Coordinate, 3> of{};
    bool acts = false;    ///< the impulses are included in the body's change of velocity
    int first = -1;       ///< index of its first row in the hand's island; -1: not in it
    int first_cone = -1;  ///< index of its first cone in another island
    bool solved = false;  ///< another island's solution was found
  };
  [[nodiscard]] static double sweep(Tree& tree, btVector3& change) noexcept;

  std::vector<Tree> trees_;
};

}  // namespace wholehand::bullet
