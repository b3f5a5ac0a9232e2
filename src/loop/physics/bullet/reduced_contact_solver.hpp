#pragma once

#include "loop/core/axis_array.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/physics/bullet/body_rows.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/cone_newton.hpp"
#include "loop/physics/bullet/hand_rows.hpp"
#include "loop/physics/bullet/joint_rows.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"
#include "loop/physics/bullet/row_velocities.hpp"
#include "loop/physics/bullet/solver_settings.hpp"

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

#include <array>
#include <vector>

namespace wholehand::bullet {

/// A solver row between the hand's reduced velocities and a rigid body's velocities.
struct ReducedRow {
  std::array<double, kMaxAxes> jacobian{};  ///< j = Gᵀ Jᵀ d
  btVector3 linear, angular;                ///< direction of the row's impulse on the body
  double lacking = 0.0;                     ///< change of velocity that reaches the target
  /// Accumulated impulse; before the sweeps, the starting impulse [N·s or N·m·s].
  double impulse = 0.0;
  // Data for the sweeps.
  std::array<double, kMaxAxes> response{};  ///< M_r⁻¹ j
  btVector3 linear_response;                ///< linear / m; 0 on a fixed body
  btVector3 angular_response;               ///< I⁻¹ angular; 0 on a fixed body
  EndShares end_shares{};                   ///< shares that the joint ends bear
  double effective_mass = 0.0;              ///< 1 / (j·M_r⁻¹ j + body); 0 disables the row
  double target = 0.0;                      ///< impulse that alone would reach the target velocity
};

/// Bound of the normal impulses of all contacts of the hand with one body.
struct ImpulseBound {
  double most = 1e30;    ///< bound of their sum in this step [N·s]
  double pressed = 0.0;  ///< their sum so far
};

/// A contact point between a capsule of the hand and a body, with its four rows.
struct HandContact {
  btManifoldPoint* point = nullptr;
  int capsule = -1;
  int body = -1;
  int solver_body = -1;
  double friction = 0.0;
  btVector3 normal, tangent1, tangent2;  ///< unit, world; the normal from the body to the hand
  btVector3 on_hand;                     ///< world [m]
  double distance_m = 0.0;
  ImpulseBound* bound = nullptr;  ///< null: unbounded
  ReducedRow normal_row, tangent1_row, tangent2_row, spin_row;
  /// Distance that the surfaces have crept along the tangents while friction held them [m]. The
  /// rows undo a share of it in each step. Rolling leaves no drift.
  double drift1_m = 0.0, drift2_m = 0.0;
  FrictionDisc<double> disc;  ///< friction of both tangents; its limit is that of the last sweep
  double lead = 0.0;  ///< against a wall: starting impulse of the normal less the last one [N·s]
  double yielding = 0.0;  ///< R / (R + inverse mass) of the normal row, R as SolverSettings says
  bool rests_on_ends = false;  ///< joint ends bear a share of its friction
};

/// Bullet's rigid-body solver, extended by the contacts of the hand. These are solved in the hand's
/// reduced velocities q̇_s, so that every impulse keeps θ = θ₀ + G q_s exactly. There are no gear
/// constraints that compete with the contact rows, and six unknowns instead of nineteen joints.
///
/// Self-contacts and joint limits of the hand (HandRows) are solved together with them: directly by
/// ConeNewton, or by sweeps of projected Gauss-Seidel when the hand touches many bodies, or bodies
/// that touch others. BodyRows sweeps contacts between bodies; bodies that the hand does not touch
/// get fewer sweeps.
class ReducedContactSolver final : public btSequentialImpulseConstraintSolver {
 public:
  /// @pre kinematics and rows outlive this @param bodies number of bodies in the scene
  ReducedContactSolver(const HandModel& hand, const ArticulatedBody& kinematics, HandRows& rows,
                       const SolverSettings& settings, int bodies);

  /// Clears the contacts of the last step. @param inverse M_r⁻¹
  /// @param velocity q̇_s at the end of the step without contacts
  void beginStep(const AxisMatrix& inverse, const AxisVelocity& velocity);
  /// Clears the contacts of the last step.
  void forgetStep() { contact_count_ = dropped_ = 0; }
  /// Bounds the sum of the normal impulses between the hand and a body in the following steps; this
  /// bounds friction too. Real-time safe.
  void boundBody(int body, double most_ns) noexcept {
    bounded_[body] = true;
    bounds_[body].most = most_ns;
  }
  /// Real-time safe.
  void unboundBody(int body) noexcept { bounded_[body] = false; }
  /// Sum of the normal impulses between the hand and a body in the last step [N·s]. Real-time safe.
  [[nodiscard]] double impulseOn(int body) const noexcept;
  /// q̇_s at the end of the step.
  [[nodiscard]] AxisVelocity velocity() const;

  /// Adds a body that moves on a joint. @pre both outlive this
  void addJoint(btRigidBody& rigid, BodyJoint& joint) { joints_.add(rigid, joint); }
  /// Adds the bodies of a tree of joints, in the order of its links. @pre all outlive this
  void addChain(const std::vector<btRigidBody*>& links, JointChain& chain) {
    joints_.add(links, chain);
  }

  [[nodiscard]] const SolverSettings& settings() const { return settings_; }
  [[nodiscard]] int contactCount() const { return contact_count_; }
  [[nodiscard]] const HandContact& contact(int i) const { return contacts_[i]; }
  /// True when the last sweep of the last step changed an impulse by more than a twentieth of the
  /// largest.
  [[nodiscard]] bool unsettled() const { return near_unsettled_ || far_unsettled_; }
  /// Contact points dropped in the last step because the list was full.
  [[nodiscard]] int dropped() const { return dropped_; }

 protected:
  void convertContacts(btPersistentManifold** manifolds, int count,
                       const btContactSolverInfo& info) override;
  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int body_count,
                                btPersistentManifold** manifolds, int manifold_count,
                                btTypedConstraint** constraints, int constraint_count,
                                const btContactSolverInfo& info, btIDebugDraw* drawer) override;
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count,
                                         const btContactSolverInfo& info) override;

 private:
  [[nodiscard]] static int mostBodyContacts(int bodies);
  [[nodiscard]] static int mostSolverBodies(int bodies);
  void reserve(int bodies);
  void convertBodyManifold(btPersistentManifold& manifold, const btContactSolverInfo& info);
  void convertHandManifold(btPersistentManifold& manifold, const ColliderTag& hand,
                           const ColliderTag& body, bool hand_is_a,
                           const btContactSolverInfo& info);
  void setUpContact(HandContact& contact, const ColliderTag& tag, const btRigidBody& owner,
                    const btVector3& on_body, const btContactSolverInfo& info);
  void aim(ReducedRow& row, const btSolverBody& body, const SolverJoint* on,
           double goal_velocity) const;
  void startFromLast(HandContact& contact, double step_s) const;
  void prepareSweeps();
  /// The joint ends that bear a row's impulse. kPressed: those against which the row presses.
  /// kHeld: those that bore an impulse in the last step, whatever the sign. kFree: none.
  enum class Ends { kPressed, kHeld, kFree };
  void finishRow(ReducedRow& row, const btSolverBody& body, bool angular, Ends ends,
                 double softness = 0.0) const;
  void finishFriction(HandContact& contact, Ends ends) const;
  [[nodiscard]] bool pullsAtEnd(const HandContact& contact) const;
  void start(HandContact& contact);
  template <class Velocities>
  [[gnu::always_inline]] inline void press(HandContact& contact, Velocities& velocities,
                                           double wanted);
  [[nodiscard]] bool solveAtOnce();
  [[nodiscard]] bool listIsland();
  void writeRow(const ReducedRow& row, int body, ConeNewton::Row& out) const;
  [[nodiscard]] bool addJointsTo();
  [[nodiscard]] bool withinBounds();
  void takeImpulses();
  void findTouched();
  static constexpr int kNarrow = 8;  // most devices have at most this many axes
  // The inner loop. Width is a compile-time multiple of the SIMD width and at least the number of
  // axes; elements beyond the axes are zero.
  template <int Width>
  [[gnu::always_inline]] inline void iterate();
  [[nodiscard]] bool changesStill() const;
  void iterateNarrow();
  void iterateWide();
  template <int Width>
  void respond(ReducedRow& row) const;
  template <int Width>
  [[gnu::always_inline]] inline void iterateAmongBodies();
  template <int Width>
  [[gnu::always_inline, nodiscard]] inline MemoryVelocities<Width> velocitiesAt(
      const HandContact& contact);
  template <class Velocities>
  [[gnu::always_inline, nodiscard]] inline double wanted(const ReducedRow& row,
                                                         const Velocities& velocities) const;
  template <class Velocities>
  [[gnu::always_inline]] inline void apply(ReducedRow& row, Velocities& velocities, double impulse);
  template <class Velocities>
  [[gnu::always_inline]] inline void pressAgain(HandContact& contact, Velocities& velocities);
  template <class Velocities>
  [[gnu::always_inline]] inline void solveFriction(HandContact& contact, Velocities& velocities);
  void solveTouched();
  [[nodiscard]] bool solveWithHand(int island);
  [[nodiscard]] bool addHandTo(IslandNewton& newton, int island, int slot);
  void takeHandFrom(const IslandNewton& newton, int first, int slot);
  void keepDrift(HandContact& contact, double step_s);

  const int axes_;
  const SolverSettings settings_;
  double softness_ = 0.0;  ///< R of the normal rows in this step [1/kg]
  int sweeps_ = 0;         ///< over the hand's contacts in this step, at least
  const ArticulatedBody& kinematics_;
  HandRows& rows_;             ///< self-contacts and joint limits of the hand
  bool couples_ends_ = false;  ///< a row is coupled to a joint end in this step
  bool one_body_ = false;      ///< all contacts are with one body, and no joint end is coupled
  AxisMatrix inverse_;         ///< M_r⁻¹, padded with zeros to the loop's width
  std::vector<HandContact> contacts_;  ///< fixed size; the first contact_count_ are in use
  std::vector<bool> bounded_;          ///< per body of the scene
  std::vector<ImpulseBound> bounds_;   ///< per body of the scene; valid where bounded_ is true
  int contact_count_ = 0;
  int dropped_ = 0;
  std::array<double, kMaxAxes> velocity_{};  ///< q̇_s before the contacts
  std::array<double, kMaxAxes> change_{};    ///< Δq̇_s by the contacts
  double residual_ = 0.0;  ///< largest squared change of an impulse in the last sweep
  /// True when the sweeps over the hand's contacts (near), or over those of other bodies (far), did
  /// not settle.
  bool near_unsettled_ = false, far_unsettled_ = false;
  /// A body that the hand touches; its unknowns are velocities in which its inertia is 1.
  struct IslandBody {
    int solver_body = -1;
    double linear = 0.0;     ///< root of the linear part of its Mobility
    InertiaRoot<3> angular;  ///< root of the angular part
  };
  ConeNewton newton_;
  bool at_once_ = false;            ///< newton_ solved this step
  bool far_done_ = false;           ///< contacts that the hand does not touch need no more sweeps
  AxisRoot root_;                   ///< root of M_r⁻¹
  std::vector<IslandBody> island_;  ///< bodies that the hand touches
  std::vector<int> slot_;           ///< per solver body: its index in the island, or −1
  /// Per solver body: the hand touches it; and the same with every body on a joint.
  std::vector<bool> by_hand_, touched_;
  BodyRows body_rows_;  ///< contacts between bodies
  JointRows joints_;    ///< friction and ends of bodies on joints
};

}  // namespace wholehand::bullet
