#pragma once

#include "loop/physics/body_joint.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/chain_rows.hpp"
#include "loop/physics/bullet/cone_newton.hpp"
#include "loop/physics/bullet/island_newton.hpp"
#include "loop/physics/joint_chain.hpp"

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <deque>
#include <vector>

/// Bodies on joints in the solver. A body on one joint has a single velocity, q̇. The solver stores
/// the change of q̇ as the x of the body's change of angular velocity and nothing else. A row that
/// acts on the body by (linear, angular) acts on q̇ by j = linear · v_a + angular · ω_a, with v_a
/// and ω_a the twist of the joint. A tree of joints (JointChain) is one body of the solver, with up
/// to three such velocities; a row on any of its links acts on them.
namespace wholehand::bullet {

/// The coordinates on which a rigid body moves: that of its joint, or those of a tree.
struct SolverJoint {
  const BodyJoint* joint = nullptr;   ///< null: the body is a link of a tree
  const JointChain* chain = nullptr;  ///< the tree; null: the body has one joint
  int link = -1;                      ///< of the tree
  btRigidBody* lead = nullptr;        ///< its body of the solver has the coordinates
};

/// The coordinates of a rigid body; null when the body is free.
[[nodiscard]] inline const SolverJoint* jointOf(const btRigidBody& rigid) noexcept {
  return static_cast<const SolverJoint*>(rigid.getUserPointer());
}

/// False for the solver's body that stands for all fixed ones.
[[nodiscard]] inline bool moves(const btSolverBody& body) noexcept {
  return body.m_originalBody != nullptr;
}
/// The coordinates of a body in the solver; null when it has none.
[[nodiscard]] inline const SolverJoint* jointOf(const btSolverBody& body) noexcept {
  return moves(body) ? jointOf(*body.m_originalBody) : nullptr;
}

/// The rigid body whose body of the solver an impulse on this one acts on.
[[nodiscard]] inline btRigidBody& leadOf(btRigidBody& rigid) noexcept {
  const SolverJoint* on = jointOf(rigid);
  return on != nullptr ? *on->lead : rigid;
}

// What is done for a link of a tree; apart, so that the code for one joint stays small.
void projectOnChain(const SolverJoint& on, btVector3& linear, btVector3& angular) noexcept;
[[nodiscard]] double rateAlongChain(const SolverJoint& on, const btVector3& row) noexcept;

/// Projects a row on a body onto the rates of its coordinates.
inline void projectOnJoint(const SolverJoint& on, btVector3& linear, btVector3& angular) noexcept {
  if (on.chain != nullptr) return projectOnChain(on, linear, angular);
  const BodyJoint::Twist twist = on.joint->twist();
  angular = {toEigen(linear).dot(twist.linear) + toEigen(angular).dot(twist.angular), 0.0, 0.0};
  linear.setZero();
}

/// Velocity along a row on the coordinates before the contacts. Real-time safe.
[[nodiscard]] inline double rateAlong(const SolverJoint& on, const btVector3& row) noexcept {
  return on.chain == nullptr ? row.x() * on.joint->rate() : rateAlongChain(on, row);
}

/// Rates of the coordinates before the contacts. Real-time safe.
[[nodiscard]] inline btVector3 ratesOf(const SolverJoint& on) noexcept {
  return on.chain != nullptr ? toBt(on.chain->rate()) : btVector3(on.joint->rate(), 0.0, 0.0);
}

/// Change of a body's velocities per unit of impulse, in the solver's form.
struct Mobility {
  double linear = 0.0;  ///< [1/kg]
  btMatrix3x3 angular;  ///< [1/(kg·m²)]
};
[[nodiscard]] inline Mobility mobilityOf(const btRigidBody& rigid) noexcept {
  if (const SolverJoint* on = jointOf(rigid)) {
    if (on->chain != nullptr) return {0.0, toBt(on->chain->mobility())};
    return {0.0, {on->joint->yield(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}};
  }
  return {rigid.getInvMass(), rigid.getInvInertiaTensorWorld()};
}

/// Constraint rows of the joints themselves: dry friction, and the ends of their ranges. Real-time
/// safe except for add().
class JointRows {
 public:
  using Bodies = btAlignedObjectArray<btSolverBody>;

  /// Adds a body on a joint. @pre both outlive this
  void add(btRigidBody& rigid, BodyJoint& joint);
  /// Adds the bodies of a tree, in the order of its links. @pre all outlive this
  void add(const std::vector<btRigidBody*>& links, JointChain& chain);
  [[nodiscard]] bool any() const noexcept { return !rows_.empty() || chains_.any(); }

  /// Begins a step with the impulses of the last step. @param touched per body of the solver: set
  /// to true for bodies on joints
  void begin(std::vector<bool>& touched) noexcept;
  /// Solves the rows of every joint that is not in an island. @return the largest change of an
  /// impulse
  double solve(Bodies& bodies) noexcept;
  /// Adds the joint rows of a solver body to an island's system, if the body is on a joint.
  /// @param unknown index of the x of the body's angular velocity @return false: no room
  [[nodiscard]] bool addTo(ConeNewton& newton, int body, int unknown) noexcept;
  /// The same for an island that the hand does not touch. @param slot the body's index in it
  [[nodiscard]] bool addTo(IslandNewton& newton, int body, int slot) noexcept;
  /// Takes the impulses of an island's rows.
  void takeFrom(const ConeNewton& newton) noexcept;
  /// The same for one body of an island that the hand does not touch.
  void takeFrom(const IslandNewton& newton, int body) noexcept;
  /// True when an end of a range bore a row along these coordinates in the last step, as
  /// long as this one is not solved.
  [[nodiscard]] bool endBears(const SolverJoint& on, const btVector3& along) const noexcept;
  /// Marks all rows as outside of the hand's island, after no solution was found.
  void release() noexcept;

 private:
  struct Row {
    btRigidBody* rigid = nullptr;
    BodyJoint* joint = nullptr;
    int body = -1;  ///< index of the solver body in this step; -1: the body rests
    double friction = 0.0, end = 0.0;  ///< impulses of dry friction and of an end
    bool acts = false;  ///< the impulses are included in the body's change of velocity
    int first = -1;     ///< index of its first row in the hand's island; -1: not in it
    /// Index of its first cone in another island.
    int first_cone = -1;
    bool solved = false;  ///< another island's solution was found
  };
  std::vector<Row> rows_;
  std::deque<SolverJoint> on_;  ///< addresses must stay: the rigid bodies point to them
  ChainRows chains_;
};

}  // namespace wholehand::bullet
