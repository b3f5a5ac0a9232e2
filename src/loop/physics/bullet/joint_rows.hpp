#pragma once

#include "loop/physics/body_joint.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/cone_newton.hpp"

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <vector>

/// Bodies on a joint in the solver. Such a body has one velocity, q̇. The solver keeps its change as
/// the x of the body's change of spin, and no other: a row that acts on the body by (linear,
/// angular) acts on q̇ by j = linear · v_a + angular · ω_a, v_a and ω_a the joint's twist.
namespace wholehand::bullet {

/// The joint of a rigid body; null: it is free.
[[nodiscard]] inline const BodyJoint* jointOf(const btRigidBody& rigid) noexcept {
  return static_cast<const BodyJoint*>(rigid.getUserPointer());
}

/// Turns a row on a body into one on the joint's q̇.
inline void projectOnJoint(const BodyJoint& joint, btVector3& linear, btVector3& angular) noexcept {
  const BodyJoint::Twist twist = joint.twist();
  angular = {toEigen(linear).dot(twist.linear) + toEigen(angular).dot(twist.angular), 0.0, 0.0};
  linear.setZero();
}

/// Change of a body's velocities per impulse, as the solver keeps them.
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

/// Rows of the joints alone: dry friction, and the ends of their ranges. Real-time safe except for
/// add().
class JointRows {
 public:
  using Bodies = btAlignedObjectArray<btSolverBody>;

  /// Adds a body on a joint. @pre both outlive this
  void add(btRigidBody& rigid, BodyJoint& joint);
  [[nodiscard]] bool any() const noexcept { return !rows_.empty(); }

  /// Begins a step with what the last one ended with. @param touched per body of the solver: those
  /// on joints become true
  void begin(std::vector<bool>& touched) noexcept;
  /// Solves each joint's rows but those of an island. @return the largest change of an impulse
  double solve(Bodies& bodies) noexcept;
  /// Adds the rows of a body of the solver to an island's solution, where it is on a joint.
  /// @param unknown index of its x of spin @return false: no room
  [[nodiscard]] bool addTo(ConeNewton& newton, int body, int unknown) noexcept;
  /// Takes the impulses of an island's rows.
  void takeFrom(const ConeNewton& newton) noexcept;
  /// No row is of an island: no solution was found.
  void release() noexcept;

 private:
  struct Row {
    btRigidBody* rigid = nullptr;
    BodyJoint* joint = nullptr;
    int body = -1;                     ///< of the solver in this step; -1: it rests
    double friction = 0.0, end = 0.0;  ///< impulses
    bool acts = false;                 ///< they are part of the body's change of velocity
    int first = -1;                    ///< of its rows in an island's solution
  };
  std::vector<Row> rows_;
};

}  // namespace wholehand::bullet
