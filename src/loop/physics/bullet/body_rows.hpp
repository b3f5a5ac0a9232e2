#pragma once

#include "loop/physics/bullet/island_newton.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <array>
#include <vector>

namespace wholehand::bullet {

class JointRows;     // loop/physics/bullet/joint_rows.hpp
struct SolverJoint;  // loop/physics/bullet/joint_rows.hpp

/// Goals of the contacts between bodies in one step.
struct ContactGoals {
  double step_s = 0.0;
  double slop_m = 0.0;         ///< overlap that is not corrected
  double erp = 0.0;            ///< fraction of a deeper overlap that is removed
  double most_push_m_s = 0.0;  ///< largest speed of this correction, because bodies keep that speed
  double warm_start = 0.0;     ///< fraction of the last step's impulses
  double bounce_from_m_s = 0.0;  ///< smallest approach speed at which bodies bounce
};

/// Constraint rows of the contacts between bodies: two separated bodies may close the gap in this
/// step, but not overlap. Projected Gauss-Seidel sweeps four contacts at once: contacts that share
/// a movable body keep their order, and four contacts that share none form a group. The two
/// directions of friction are one unknown, a vector within Coulomb's disc (row_arithmetic.hpp).
/// Real-time safe except for construction.
class BodyRows {
 public:
  using Bodies = btAlignedObjectArray<btSolverBody>;

  /// @param contacts, bodies largest numbers of contacts and of bodies
  BodyRows(int contacts, int bodies);

  /// Begins a step.
  void clear() noexcept;
  /// Number of contacts that may still be added.
  [[nodiscard]] int room() const noexcept { return static_cast<int>(groups_.size()) - contacts_; }
  /// Adds the contacts of a manifold after the existing ones and sets the points' directions of
  /// friction. @param a, b its bodies @param touched per body: true when the hand changes its
  /// velocity between sweeps; the contacts of such a body are "near"
  void add(btPersistentManifold& manifold, int a, int b, const ContactGoals& goals,
           const Bodies& bodies, const std::vector<bool>& touched) noexcept;
  /// Reads the velocities of the bodies and applies the starting impulses. Call after the last
  /// contact is added and before the first sweep.
  void begin(Bodies& bodies, const std::vector<bool>& touched) noexcept;
  [[nodiscard]] bool any() const noexcept { return contacts_ > 0; }
  [[nodiscard]] bool anyNear() const noexcept { return !near_.empty(); }
  /// True when the hand touches one of two bodies in contact whose masses differ by more than a
  /// factor of ten.
  [[nodiscard]] bool nearUneven() const noexcept { return near_uneven_; }
  /// Largest normal impulse after the last sweep [N·s].
  [[nodiscard]] double pressed() const noexcept { return pressed_; }
  /// Number of groups; the cost of a sweep is proportional to it.
  [[nodiscard]] int groups() const noexcept { return group_count_; }
  /// Makes one sweep: all normal rows, then all friction rows; every second sweep goes backwards.
  /// Reads the velocities of touched bodies from `bodies` and writes them back. @return largest
  /// change of an impulse [N·s]
  [[nodiscard]] double sweepAll(Bodies& bodies) noexcept;
  /// Makes one sweep over the near contacts only.
  [[nodiscard]] double sweepNear(Bodies& bodies) noexcept;
  /// Solves the islands that the hand does not touch directly, as far as a bounded work allows
  /// (IslandNewton), with the rows of their joints. Their contacts are not swept. Call after
  /// begin() and before the first sweep. @param by_hand per body: true when the hand touches it
  void solveIslands(Bodies& bodies, const std::vector<bool>& by_hand, JointRows& joints) noexcept;
  /// True when the hand touches an island of several bodies, none of them on a joint.
  [[nodiscard]] bool anyTouchedIsland() const noexcept { return !touched_islands_.empty(); }
  /// Adds what an impulse of the hand changes of a body's velocity in this step.
  void addHand(int body, const btVector3& linear, const btVector3& angular) noexcept;
  /// Solves the islands of several bodies that the hand touches once more, directly, for the
  /// impulses of the hand that the sweeps found: what they leave of the errors between bodies would
  /// give energy. Call after the last sweep and the last addHand().
  void solveTouched(Bodies& bodies, JointRows& joints) noexcept;
  /// The only such island; -1: there are none or several.
  [[nodiscard]] int onlyTouchedIsland() const noexcept {
    return touched_islands_.size() == 1 ? touched_islands_.front() : -1;
  }
  /// Begins to solve an island with the hand as one more body; islandNewton() then takes the hand's
  /// rows. @return the hand's slot; -1: no room
  [[nodiscard]] int beginWithHand(int island, const Bodies& bodies) noexcept;
  [[nodiscard]] IslandNewton& islandNewton() noexcept { return newton_; }
  /// Slot of a body in the island that was begun, or -1.
  [[nodiscard]] int slotIn(int island, int body) noexcept;
  /// Writes a row of the hand on the body in a slot.
  void writeHandRow(int slot, const btVector3& linear, const btVector3& angular,
                    IslandNewton::Six& along) const noexcept;
  /// Finds the impulses of the island that was begun. @return false: none were found
  [[nodiscard]] bool solveBegun() noexcept;
  /// Takes them after beginWithHand().
  void takeWithHand(int island, Bodies& bodies, JointRows& joints) noexcept;
  /// True when contacts are left to sweep.
  [[nodiscard]] bool anyToSweep() const noexcept { return !all_.empty(); }
  /// Writes the impulses to their contact points, and the velocities of the bodies that are not
  /// touched.
  void write(Bodies& bodies) const noexcept;

 private:
  static constexpr int kWide = 4;  ///< contacts of a group
  /// Change of a body's velocity in this step.
  struct alignas(64) Motion {
    std::array<double, 4> linear{}, angular{};  ///< x, y, z, 0
  };
  /// State of a body before the contacts, as the rows use it. A body on a joint has its rate q̇ as
  /// the x of its angular velocity.
  struct alignas(32) State {
    std::array<double, 4> linear{}, angular{};  ///< velocities x, y, z; the fourth number is unused
    std::array<std::array<double, 4>, 3> mobility{};  ///< angular velocity per impulse, by rows
  };
  /// One number, and one vector, for each contact of a group.
  using Each = std::array<double, kWide>;
  using EachVector = std::array<Each, 3>;
  struct alignas(32) Row {
    EachVector along;  ///< direction of the impulse on the first body; the second has the opposite
    EachVector about_a, about_b;        ///< torque per unit of impulse
    EachVector response_a, response_b;  ///< change of the angular velocity per unit of impulse
    Each target;                        ///< impulse that alone would reach the target velocity
    Each effective_mass;
    Each impulse;
  };
  struct alignas(32) Group {
    Row normal, tangent1, tangent2;
    Each inverse_mass_a, inverse_mass_b, friction;
    /// Velocity along the tangents per unit of impulse, a symmetric matrix, and its inverse.
    Each yield_11, yield_12, yield_22, mass_11, mass_12, mass_22;
    EachVector arm_a, arm_b;  ///< from the body's centre to the contact
    Each goal;                ///< goal velocity along the normal
    std::array<Motion*, kWide> a, b;
    std::array<const State*, kWide> before_a, before_b;
    std::array<const SolverJoint*, kWide> joint_a, joint_b;  ///< null: the body has no joint
    std::array<btManifoldPoint*, kWide> point;
    bool has_joint = false;
    int run = 0;
    int used = 0;  ///< number of places with a contact, the first ones; the others have no body and
                   ///< are zero
  };
  struct Velocities;
  struct RowDirection;
  struct IslandBody {
    double linear = 0.0;     ///< 1 / √m
    InertiaRoot<3> angular;  ///< root of I⁻¹
  };
  struct Place {
    Group* group = nullptr;
    int place = 0;
  };

  /// Energy of an island's starting impulses (shortenStart()) [J].
  struct Start {
    double cost_j = 0.0, gain_j = 0.0;
    double share = 1.0;  ///< share of the starting impulses that is applied
  };

  /// Index of a movable body of the contact.
  [[nodiscard]] int moverOf(const Group& group, int place) const noexcept;
  [[nodiscard]] static bool isUneven(const Group& group, int place) noexcept;
  [[nodiscard]] int islandOf(int body) noexcept;
  void findIslands(const Bodies& bodies) noexcept;
  void shortenStart(const Bodies& bodies) noexcept;
  void sortByIsland(const Bodies& bodies, const std::vector<bool>& by_hand) noexcept;
  [[nodiscard]] bool fits(int island, int further) const noexcept;
  void beginIsland(int island, const Bodies& bodies, int further) noexcept;
  void beginTouched(int island, const Bodies& bodies, int further) noexcept;
  [[nodiscard]] bool solveIsland(int island, const Bodies& bodies, JointRows& joints) noexcept;
  void putMotions(int island, Bodies& bodies) noexcept;
  void writeRow(const Row& row, const Place& at, int r, IslandNewton::Contact& out) const noexcept;
  void noteTouched(int island, const Bodies& bodies) noexcept;
  void subtractHand(const Place& at, IslandNewton::Contact& contact) const noexcept;
  void takeImpulses(int island, Bodies& bodies, JointRows& joints) noexcept;
  static void silence(Group& group, int place) noexcept;

  [[nodiscard]] Group& groupFor(int run) noexcept;
  void leaveEmpty(Group& group, int place) noexcept;
  void put(Group& group, int place, int a, int b, const btRigidBody* rigid_a,
           const btRigidBody* rigid_b) noexcept;
  static void lay(const std::vector<Group*>& groups) noexcept;
  [[gnu::always_inline]] static inline void lay(Group& group);
  [[gnu::always_inline]] static inline void press(Group& group, FourNumbers& most);
  [[gnu::always_inline]] static inline void rub(Group& group, const FourNumbers& normal,
                                                FourNumbers& most);
  [[nodiscard]] double sweep(Bodies& bodies, const std::vector<Group*>& groups) noexcept;
  [[nodiscard]] static double sweep(const std::vector<Group*>& groups, bool backwards,
                                    double& pressed) noexcept;

  std::vector<Group> groups_;        ///< fixed size; the first group_count_ are in use
  std::vector<Group*> all_, near_;   ///< groups in the order of sweeps
  std::vector<Motion> motions_;      ///< per body; the last element stands for "no body"
  std::vector<State> states_;        ///< per body; the last element stands for "no body"
  std::vector<int> touched_, free_;  ///< movable bodies
  std::vector<int> depth_;           ///< per body: depth of its next contact
  /// Per run: its group with a free place, or null. The depth of a contact is one more than the
  /// depth of the last contact before it that shares a movable body. The contacts of a run have the
  /// same depth, so they share no movable body. Each depth has one run of near contacts and one of
  /// the others.
  std::vector<Group*> open_;
  std::vector<int> first_;    ///< per run: index of its first group in all_
  bool near_uneven_ = false;  ///< the hand touches one of two bodies of very different mass
  std::vector<Start> start_;  ///< per island
  /// Per body: another body of its island; one body per island names itself.
  std::vector<int> island_;
  std::vector<int> slot_;         ///< per body: its index in its island, or −1
  std::vector<char> swept_;       ///< per island: the hand touches it, or no solution was found
  std::vector<int> first_body_;   ///< per island: index of its first body in members_
  std::vector<int> first_place_;  ///< per island: index of its first contact in places_
  std::vector<int> members_;
  std::vector<int> touched_islands_;  ///< of several bodies, none of them on a joint
  int work_ = 0;  ///< left for factorisations in this step, in products of blocks
  std::vector<Place> places_;
  std::vector<Motion> hand_;  ///< per body: changes by the hand; the last element is "no body"
  std::array<IslandBody, IslandNewton::kMostBodies> roots_;
  IslandNewton newton_;
  int contacts_ = 0, group_count_ = 0, runs_ = 0;
  double pressed_ = 0.0;
  /// Direction of the next sweep; alternating sweeps carry loads up and down a stack.
  bool backwards_ = false;
};

}  // namespace wholehand::bullet
