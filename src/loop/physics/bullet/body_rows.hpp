#pragma once

#include "loop/physics/bullet/cone_newton.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <LinearMath/btAlignedObjectArray.h>

#include <array>
#include <vector>

namespace wholehand {
class BodyJoint;  // loop/physics/body_joint.hpp
}

namespace wholehand::bullet {

/// What a step's contacts between bodies aim at.
struct ContactGoals {
  double step_s = 0.0;
  double slop_m = 0.0;           ///< overlap that is left alone
  double erp = 0.0;              ///< fraction of a deeper overlap that is removed
  double most_push_m_s = 0.0;    ///< the fastest that this pushes: bodies keep the speed
  double warm_start = 0.0;       ///< fraction of the last step's impulses
  double bounce_from_m_s = 0.0;  ///< slower bodies do not bounce
};

/// Rows of the contacts between two bodies: where they are apart, they may close the gap in this
/// step and no further. Projected Gauss-Seidel sweeps four contacts at once: contacts that share a
/// movable body keep their order, and four that share none form a group. The two directions of
/// friction are one unknown, a vector within Coulomb's disc (row_arithmetic.hpp). Real-time safe
/// except for construction.
class BodyRows {
 public:
  using Bodies = btAlignedObjectArray<btSolverBody>;

  /// @param contacts, bodies most of them
  BodyRows(int contacts, int bodies);

  /// Begins a step.
  void clear() noexcept;
  /// Number of contacts that may still be added.
  [[nodiscard]] int room() const noexcept { return static_cast<int>(groups_.size()) - contacts_; }
  /// Adds the contacts of a manifold after those that are there. Lays the points' directions of
  /// friction. @param a, b its bodies @param touched per body: the hand changes its velocity
  /// between sweeps, and its contacts are near
  void add(btPersistentManifold& manifold, int a, int b, const ContactGoals& goals,
           const Bodies& bodies, const std::vector<bool>& touched) noexcept;
  /// Takes the velocities of the bodies, and lets the starting impulses act. Call after the last
  /// contact and before the first sweep.
  void begin(Bodies& bodies, const std::vector<bool>& touched) noexcept;
  [[nodiscard]] bool any() const noexcept { return contacts_ > 0; }
  [[nodiscard]] bool anyNear() const noexcept { return !near_.empty(); }
  /// The hand touches a body that lies on one ten times lighter, or below one ten times heavier.
  [[nodiscard]] bool nearUneven() const noexcept { return near_uneven_; }
  /// Largest normal impulse after the last sweep [N·s].
  [[nodiscard]] double pressed() const noexcept { return pressed_; }
  /// Number of groups: a sweep costs as many steps.
  [[nodiscard]] int groups() const noexcept { return group_count_; }
  /// One sweep: all normals, then all friction; every second one backwards. Takes the velocities of
  /// touched bodies from `bodies`, and puts them there. @return largest change of an impulse [N·s]
  [[nodiscard]] double sweepAll(Bodies& bodies) noexcept;
  /// The same over near contacts only.
  [[nodiscard]] double sweepNear(Bodies& bodies) noexcept;
  /// Solves at once the islands of at most eight bodies in which one lies on another ten times
  /// lighter, which sweeps do not get to the bottom of. Where the hand touches one of them, or no
  /// solution is found with a bounded number of factorisations, what the sweeps made stays. Call
  /// after the last sweep. @return true: there were some, and all are solved
  bool solveUneven(ConeNewton& newton, const Bodies& bodies) noexcept;
  /// Writes impulses to their contact points, and velocities of bodies that are not touched.
  void write(Bodies& bodies) const noexcept;

 private:
  static constexpr int kWide = 4;
  /// Change of a body's velocity in this step.
  struct alignas(64) Motion {
    std::array<double, 4> linear{}, angular{};  ///< the last one zero
  };
  /// A body before contacts, as rows see it: one on a joint has its rate as the x of its spin.
  struct alignas(32) State {
    std::array<double, 4> linear{}, angular{};        ///< velocity; the last one unused
    std::array<std::array<double, 4>, 3> mobility{};  ///< angular velocity per impulse, by rows
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
    /// Velocity of the tangents per impulse, a symmetric matrix, and its inverse.
    Each yield_11, yield_12, yield_22, mass_11, mass_12, mass_22;
    EachVector arm_a, arm_b;  ///< from the body's centre to the contact
    Each goal;                ///< velocity of the normal
    std::array<Motion*, kWide> a, b;
    std::array<const State*, kWide> before_a, before_b;
    std::array<const BodyJoint*, kWide> joint_a, joint_b;  ///< null: the body is free, or fixed
    std::array<btManifoldPoint*, kWide> point;
    bool has_joint = false;
    int run = 0;
    int used = 0;  ///< the first places have a contact; the others are of no body, and zero
  };
  struct Velocities;
  struct Laid;
  static constexpr int kMostUneven = 8;  ///< bodies of an island
  struct IslandBody {
    double linear = 0.0;     ///< 1 / √m
    InertiaRoot<3> angular;  ///< of I⁻¹
  };
  struct Place {
    Group* group = nullptr;
    int place = 0;
  };

  /// Of an island's starting impulses (shortenStart()) [J].
  struct Start {
    double cost_j = 0.0, gain_j = 0.0;
    double share = 1.0;  ///< that is let go
  };

  /// The body of a contact that moves, or one of the two.
  [[nodiscard]] int moverOf(const Group& group, int place) const noexcept;
  [[nodiscard]] static bool isUneven(const Group& group, int place) noexcept;
  [[nodiscard]] int islandOf(int body) noexcept;
  void findIslands(const Bodies& bodies) noexcept;
  void shortenStart(const Bodies& bodies) noexcept;
  void findUneven(const Bodies& bodies) noexcept;
  [[nodiscard]] bool listIsland(int island, const Bodies& bodies) noexcept;
  void writeRow(const Row& row, const Place& at, ConeNewton::Row& out) const noexcept;
  bool solveIsland(ConeNewton& newton, int most_steps) noexcept;
  void takeImpulses(const ConeNewton& newton) noexcept;

  [[nodiscard]] Group& groupFor(int run) noexcept;
  void leaveEmpty(Group& group, int place) noexcept;
  void put(Group& group, int place, int a, int b, const Bodies& bodies) noexcept;
  static void lay(const std::vector<Group*>& groups) noexcept;
  [[gnu::always_inline]] static inline void lay(Group& group);
  [[gnu::always_inline]] static inline void press(Group& group, FourNumbers& most);
  [[gnu::always_inline]] static inline void rub(Group& group, const FourNumbers& normal,
                                                FourNumbers& most);
  [[nodiscard]] double sweep(Bodies& bodies, const std::vector<Group*>& groups) noexcept;
  [[nodiscard]] static double sweep(const std::vector<Group*>& groups, bool backwards,
                                    double& pressed) noexcept;

  std::vector<Group> groups_;        ///< fixed size; the first group_count_ are in use
  std::vector<Group*> all_, near_;   ///< in the order of sweeps
  std::vector<Motion> motions_;      ///< per body; the last one of no body
  std::vector<State> states_;        ///< the same
  std::vector<int> touched_, free_;  ///< movable bodies
  std::vector<int> depth_;           ///< per body: of its next contact
  /// Per run: its group with a free place, or null. A run's contacts share no movable body: they
  /// are equally deep, which is one deeper than the last contact before with either body. Each
  /// depth has a run of near contacts and one of the others.
  std::vector<Group*> open_;
  std::vector<int> first_;            ///< per run: its first place in all_
  bool uneven_ = false;               ///< a contact in this step is
  bool near_uneven_ = false;          ///< one of a body that the hand touches is
  std::vector<Start> start_;          ///< per island
  std::vector<int> island_;           ///< per body: one of its island; itself for one of each
  std::vector<bool> solved_at_once_;  ///< per island, at that body
  std::vector<int> slot_;             ///< per body: its index in the island, or −1
  std::array<int, kMostUneven> members_{};
  std::array<IslandBody, kMostUneven> roots_;
  int member_count_ = 0;
  std::array<Place, ConeNewton::kMostRows / 3> places_{};
  int place_count_ = 0;
  int contacts_ = 0, group_count_ = 0, runs_ = 0;
  double pressed_ = 0.0;
  bool backwards_ = false;  ///< of the next sweep: loads pass up and down a stack
};

}  // namespace wholehand::bullet
