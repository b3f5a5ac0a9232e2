#pragma once

#include "loop/physics/body_joint.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/cone_newton.hpp"
#include "loop/physics/bullet/island_newton.hpp"

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <vector>

/// Bodies on a joint in the solver. Such a body has a single velocity, q̇. The solver stores the
/// change of q̇ as the x of the body's change of angular velocity and nothing else. A row that acts
/// on the body by (linear, angular) acts on q̇ by j = linear · v_a + angular · ω_a, with v_a and
/// ω_a the twist of the joint.
namespace wholehand::bullet {

/// The joint of a rigid body; null when the body is free.
[[nodiscard]] inline const BodyJoint* jointOf(const btRigidBody& rigid) noexcept {
  return static_cast<const BodyJoint*>(rigid.getUserPointer());
}

/// False for the solver's body that stands for all fixed ones.
[[nodiscard]] inline bool moves(const btSolverBody& body) noexcept {
  return body.m_originalBody != nullptr;
}
/// The joint of a body in the solver; null when it has none.
[[nodiscard]] inline const BodyJoint* jointOf(const btSolverBody& body) noexcept {
  return moves(body) ? jointOf(*body.m_originalBody) : nullptr;
}

/// Projects a row on a body onto the q̇ of its joint.
inline void projectOnJoint(const BodyJoint& joint, btVector3& linear, btVector3& angular) noexcept {
  const BodyJoint::Twist twist = joint.twist();
  angular = {toEigen(linear).dot(twist.linear) + toEigen(angular).dot(twist.angular), 0.0, 0.0};
  linear.setZero();
}

/// Change of a body's velocities per unit of impulse, in the solver's form.
struct Mobility {
  double linear = 0.0;  ///< [1/kg]
  btMatrix3x3 angular;  ///< [1/(kg·m²)]
};
[[nodiscard]] inline Mobility mobilityOf(const btRigidBody& rigid) noexcept {
  if (const BodyJoint* joint = jointOf(rigid)) {
    return {0.0, {joint->yield(), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0}};
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
  [[nodiscard]] bool any() const noexcept { return !rows_.empty(); }

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
  /// Impulse of the end of a body's range in the last step, as long as this one is not solved: > 0
  /// at the least q. 0: no end bore.
  [[nodiscard]] double borneByEnd(const BodyJoint& joint) const noexcept;
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
};

}  // namespace wholehand::bullet
