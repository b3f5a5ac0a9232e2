#include "loop/physics/bullet/body_rows.hpp"

#include "loop/core/compiler.hpp"
#include "loop/physics/bullet/joint_rows.hpp"
#include "loop/physics/bullet/row_arithmetic.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

// Rows and sweeps. body_islands.cpp solves the islands that need no sweeps.

namespace wholehand::bullet {
namespace {

// A row with a lower mobility is off: nothing moves along it, e.g. where an impulse pushes against
// a hinge's axis [1/kg].
constexpr double kLeastMobility = 1e-12;
constexpr double kUneven = 10.0;  // ratio of two masses from which a contact is uneven

void copyVector(const btVector3& from, std::array<double, 4>& to) {
  to = {from.x(), from.y(), from.z(), 0.0};
}

void copyVector(const std::array<double, 4>& from, btVector3& to) {
  to.setValue(from[0], from[1], from[2]);
}

[[gnu::always_inline]] inline void loadVectors(FourVectors& to,
                                               const std::array<std::array<double, 4>, 3>& from) {
  load(to.x, from[0].data());
  load(to.y, from[1].data());
  load(to.z, from[2].data());
}

[[gnu::always_inline]] inline void storeVectors(const FourVectors& from,
                                                std::array<std::array<double, 4>, 3>& to) {
  store(from.x, to[0].data());
  store(from.y, to[1].data());
  store(from.z, to[2].data());
}

/// Collects four vectors, each stored with a fourth number.
[[gnu::always_inline]] inline void gather(FourVectors& to, const double* of_0, const double* of_1,
                                          const double* of_2, const double* of_3) {
  FourNumbers fourth;
  load(to.x, of_0), load(to.y, of_1), load(to.z, of_2), load(fourth, of_3);
  transpose(to.x, to.y, to.z, fourth);
}

/// The inverse of gather(); the fourth numbers become zero.
[[gnu::always_inline]] inline void scatter(const FourVectors& from, double* to_0, double* to_1,
                                           double* to_2, double* to_3) {
  FourNumbers v0 = from.x, v1 = from.y, v2 = from.z, v3{};
  transpose(v0, v1, v2, v3);
  store(v0, to_0), store(v1, to_1), store(v2, to_2), store(v3, to_3);
}

/// to = M v, M by its rows
[[gnu::always_inline]] inline void multiply(FourVectors& to,
                                            const std::array<FourVectors, 3>& matrix,
                                            const FourVectors& v) {
  dot(to.x, matrix[0], v), dot(to.y, matrix[1], v), dot(to.z, matrix[2], v);
}

/// Projects rows on bodies onto the bodies' joints. @param sign of the rows' direction
void projectOnJoints(const std::array<const SolverJoint*, 4>& joints, const FourVectors& along,
                     double sign, FourVectors& about) {
  for (int i = 0; i < 4; ++i) {
    if (joints[i] == nullptr) continue;
    btVector3 linear = sign * btVector3(along.x[i], along.y[i], along.z[i]);
    btVector3 angular(about.x[i], about.y[i], about.z[i]);
    projectOnJoint(*joints[i], linear, angular);
    about.x[i] = angular.x(), about.y[i] = angular.y(), about.z[i] = angular.z();
  }
}

void takeState(const btSolverBody& body, std::array<double, 4>& linear,
               std::array<double, 4>& angular, std::array<std::array<double, 4>, 3>& mobility) {
  linear = angular = {};
  mobility = {};
  if (!moves(body)) return;
  if (const SolverJoint* on = jointOf(body)) {
    copyVector(ratesOf(*on), angular);
    const Mobility of = mobilityOf(*body.m_originalBody);
    for (int r = 0; r < 3; ++r) copyVector(of.angular[r], mobility[r]);
    return;
  }
  copyVector(body.m_linearVelocity + body.m_externalForceImpulse, linear);
  copyVector(body.m_angularVelocity + body.m_externalTorqueImpulse, angular);
  const btMatrix3x3& inertia = body.m_originalBody->getInvInertiaTensorWorld();
  for (int r = 0; r < 3; ++r) copyVector(inertia[r], mobility[r]);
}

/// to += factor · vector
[[gnu::always_inline]] inline void addScaled(FourVectors& to, const FourNumbers& factor,
                                             const FourVectors& vector) {
  to.x += vector.x * factor;
  to.y += vector.y * factor;
  to.z += vector.z * factor;
}

/// True when any of the four comparisons is true. @param which result of a comparison
template <class Mask>
[[gnu::always_inline]] inline bool anyOf(const Mask& which) {
  return ((which[0] | which[1]) | (which[2] | which[3])) != 0;
}

[[gnu::always_inline]] inline void keepLargest(FourNumbers& most, const FourNumbers& change) {
  most = change > most ? change : most;
  most = -change > most ? -change : most;
}

}  // namespace

/// Velocities of the bodies of a group's contacts.
struct BodyRows::Velocities {
  FourVectors linear_a, angular_a, linear_b, angular_b;

  [[gnu::always_inline]] inline void take(const Group& group) {
    gather(linear_a, group.a[0]->linear.data(), group.a[1]->linear.data(),
           group.a[2]->linear.data(), group.a[3]->linear.data());
    gather(angular_a, group.a[0]->angular.data(), group.a[1]->angular.data(),
           group.a[2]->angular.data(), group.a[3]->angular.data());
    gather(linear_b, group.b[0]->linear.data(), group.b[1]->linear.data(),
           group.b[2]->linear.data(), group.b[3]->linear.data());
    gather(angular_b, group.b[0]->angular.data(), group.b[1]->angular.data(),
           group.b[2]->angular.data(), group.b[3]->angular.data());
  }

  [[gnu::always_inline]] inline void put(Group& group) const {
    scatter(linear_a, group.a[0]->linear.data(), group.a[1]->linear.data(),
            group.a[2]->linear.data(), group.a[3]->linear.data());
    scatter(angular_a, group.a[0]->angular.data(), group.a[1]->angular.data(),
            group.a[2]->angular.data(), group.a[3]->angular.data());
    scatter(linear_b, group.b[0]->linear.data(), group.b[1]->linear.data(),
            group.b[2]->linear.data(), group.b[3]->linear.data());
    scatter(angular_b, group.b[0]->angular.data(), group.b[1]->angular.data(),
            group.b[2]->angular.data(), group.b[3]->angular.data());
  }

  /// Computes the missing impulse of each row, as Bullet's resolveSingleConstraintRowGeneric()
  /// does.
  [[gnu::always_inline]] inline void compare(const Row& row, FourNumbers& lacking) const {
    FourVectors along, about_a, about_b;
    FourNumbers effective_mass, a, b, turns;
    loadVectors(along, row.along), loadVectors(about_a, row.about_a),
        loadVectors(about_b, row.about_b);
    load(lacking, row.target.data());
    load(effective_mass, row.effective_mass.data());
    dot(a, along, linear_a);
    dot(turns, about_a, angular_a);
    a += turns;
    dot(b, along, linear_b);
    dot(turns, about_b, angular_b);
    b = turns - b;
    lacking -= a * effective_mass;
    lacking -= b * effective_mass;
  }

  /// Applies a change of the row's impulse.
  [[gnu::always_inline]] inline void apply(const Row& row, const Group& group,
                                           const FourNumbers& change) {
    FourVectors along, response;
    FourNumbers inverse_mass_a, inverse_mass_b;
    loadVectors(along, row.along);
    load(inverse_mass_a, group.inverse_mass_a.data());
    load(inverse_mass_b, group.inverse_mass_b.data());
    addScaled(linear_a, change,
              {along.x * inverse_mass_a, along.y * inverse_mass_a, along.z * inverse_mass_a});
    loadVectors(response, row.response_a);
    addScaled(angular_a, change, response);
    addScaled(linear_b, -change,
              {along.x * inverse_mass_b, along.y * inverse_mass_b, along.z * inverse_mass_b});
    loadVectors(response, row.response_b);
    addScaled(angular_b, change, response);
  }
};

BodyRows::BodyRows(int contacts, int bodies)
    : groups_(contacts),
      motions_(bodies + 1),
      states_(bodies + 1),
      depth_(bodies),
      open_(2 * contacts),
      first_(2 * contacts + 1),
      start_(bodies),
      island_(bodies),
      slot_(bodies),
      swept_(bodies),
      first_body_(bodies + 1),
      first_place_(bodies + 1),
      members_(bodies),
      places_(contacts),
      hand_(bodies + 1) {
  touched_islands_.reserve(bodies);
  all_.reserve(contacts);
  near_.reserve(contacts);
  touched_.reserve(bodies);
  free_.reserve(bodies);
}

void BodyRows::clear() noexcept {
  all_.clear();
  near_.clear();
  touched_.clear();
  free_.clear();
  touched_islands_.clear();
  if (any()) std::fill(depth_.begin(), depth_.end(), 0);
  contacts_ = group_count_ = runs_ = 0;
  near_uneven_ = false;
}

BodyRows::Group& BodyRows::groupFor(int run) noexcept {
  for (; runs_ <= run; ++runs_) open_[runs_] = nullptr;
  Group*& open = open_[run];
  if (open == nullptr) {
    open = &groups_[group_count_++];
    open->run = run;
    open->used = 0;
    open->has_joint = false;
  }
  Group& group = *open;
  if (group.used == kWide - 1) open = nullptr;
  return group;
}

// Sets a place without contact: it has no bodies, and its rows are zero.
void BodyRows::leaveEmpty(Group& group, int place) noexcept {
  for (Row* row : {&group.normal, &group.tangent1, &group.tangent2}) {
    for (Each& each : row->along) each[place] = 0.0;
    row->impulse[place] = 0.0;
  }
  for (EachVector* arm : {&group.arm_a, &group.arm_b}) {
    for (Each& each : *arm) each[place] = 0.0;
  }
  group.a[place] = group.b[place] = &motions_.back();
  group.before_a[place] = group.before_b[place] = &states_.back();
  group.joint_a[place] = group.joint_b[place] = nullptr;
  group.inverse_mass_a[place] = group.inverse_mass_b[place] = group.friction[place] = 0.0;
  group.goal[place] = 0.0;
  group.point[place] = nullptr;
}

/// A direction of a contact, and the changes that an impulse along it makes.
struct BodyRows::RowDirection {
  FourVectors along, about_a, about_b, response_a, response_b;
  FourNumbers yield;  ///< change of velocity per unit of impulse

  [[gnu::always_inline]] inline void store(Row& row) const {
    storeVectors(along, row.along);
    storeVectors(about_a, row.about_a), storeVectors(about_b, row.about_b);
    storeVectors(response_a, row.response_a), storeVectors(response_b, row.response_b);
  }
};

/// Builds the three rows of a group's contacts and applies the starting impulses.
void BodyRows::lay(Group& group) {
  // Collects the states of the four contacts' bodies.
  FourVectors linear_a, angular_a, linear_b, angular_b, arm_a, arm_b;
  std::array<FourVectors, 3> mobility_a, mobility_b;
  const auto gather_states = [](FourVectors& to, const std::array<const State*, kWide>& from,
                                auto part) {
    gather(to, part(*from[0]), part(*from[1]), part(*from[2]), part(*from[3]));
  };
  const auto linear_of = [](const State& state) { return state.linear.data(); };
  const auto angular_of = [](const State& state) { return state.angular.data(); };
  gather_states(linear_a, group.before_a, linear_of),
      gather_states(linear_b, group.before_b, linear_of);
  gather_states(angular_a, group.before_a, angular_of);
  gather_states(angular_b, group.before_b, angular_of);
  for (int r = 0; r < 3; ++r) {
    const auto row_of = [r](const State& state) { return state.mobility[r].data(); };
    gather_states(mobility_a[r], group.before_a, row_of);
    gather_states(mobility_b[r], group.before_b, row_of);
  }
  loadVectors(arm_a, group.arm_a), loadVectors(arm_b, group.arm_b);
  FourNumbers inverse_mass_a, inverse_mass_b, goal;
  load(inverse_mass_a, group.inverse_mass_a.data());
  load(inverse_mass_b, group.inverse_mass_b.data());
  load(goal, group.goal.data());
  const FourNumbers none{}, one = none + 1.0, least = none + kLeastMobility;
  Velocities velocities;
  velocities.take(group);
  // Builds the normal and the two tangents, and applies their starting impulses.
  std::array<RowDirection, 3> laid;
  const std::array<Row*, 3> rows{&group.normal, &group.tangent1, &group.tangent2};
  for (int i = 0; i < 3; ++i) {
    RowDirection& to = laid[i];
    Row& row = *rows[i];
    loadVectors(to.along, row.along);
    cross(to.about_a, arm_a, to.along);
    cross(to.about_b, to.along, arm_b);
    if (group.has_joint) projectOnJoints(group.joint_a, to.along, 1.0, to.about_a);
    if (group.has_joint) projectOnJoints(group.joint_b, to.along, -1.0, to.about_b);
    multiply(to.response_a, mobility_a, to.about_a);
    multiply(to.response_b, mobility_b, to.about_b);
    FourNumbers turns_a, turns_b, rate_a, rate_b, spin_a, spin_b, start;
    dot(turns_a, to.about_a, to.response_a), dot(turns_b, to.about_b, to.response_b);
    to.yield = inverse_mass_a + inverse_mass_b + turns_a + turns_b;
    dot(rate_a, to.along, linear_a), dot(rate_b, to.along, linear_b);
    dot(spin_a, to.about_a, angular_a), dot(spin_b, to.about_b, angular_b);
    const FourNumbers effective_mass = to.yield > least ? one / to.yield : none;
    const FourNumbers lacking = (i == 0 ? goal : none) - (rate_a - rate_b + spin_a + spin_b);
    to.store(row);
    store(effective_mass, row.effective_mass.data());
    store(lacking * effective_mass, row.target.data());
    load(start, row.impulse.data());
    velocities.apply(row, group, start);
  }
  velocities.put(group);
  const RowDirection &first = laid[1], &second = laid[2];
  // Stores the 2 x 2 yield of the tangents and its inverse.
  FourNumbers coupled_a, coupled_b;
  dot(coupled_a, first.about_a, second.response_a);
  dot(coupled_b, first.about_b, second.response_b);
  const FourNumbers yield_12 = coupled_a + coupled_b;
  // Keeps the matrix definite where one joint alone moves both tangents.
  const FourNumbers definite = none + (1.0 + 1e-9);
  const FourNumbers yield_11 = definite * (first.yield > least ? first.yield : least);
  const FourNumbers yield_22 = definite * (second.yield > least ? second.yield : least);
  const FourNumbers det = yield_11 * yield_22 - yield_12 * yield_12;
  store(yield_11, group.yield_11.data()), store(yield_12, group.yield_12.data());
  store(yield_22, group.yield_22.data());
  store(yield_22 / det, group.mass_11.data()), store(-yield_12 / det, group.mass_12.data());
  store(yield_11 / det, group.mass_22.data());
}

WHOLEHAND_VECTOR_CLONES void BodyRows::lay(const std::vector<Group*>& groups) noexcept {
  for (Group* group : groups) lay(*group);
}

void BodyRows::put(Group& group, int place, int a, int b, const btRigidBody* rigid_a,
                   const btRigidBody* rigid_b) noexcept {
  group.a[place] = &motions_[a], group.b[place] = &motions_[b];
  group.before_a[place] = &states_[a], group.before_b[place] = &states_[b];
  const auto on = [](const btRigidBody* rigid) {
    return rigid != nullptr ? jointOf(*rigid) : nullptr;
  };
  group.joint_a[place] = on(rigid_a), group.joint_b[place] = on(rigid_b);
  const auto inverse_mass = [](const btRigidBody* rigid, const SolverJoint* joint) {
    return rigid != nullptr && joint == nullptr ? rigid->getInvMass() : 0.0;
  };
  group.inverse_mass_a[place] = inverse_mass(rigid_a, group.joint_a[place]);
  group.inverse_mass_b[place] = inverse_mass(rigid_b, group.joint_b[place]);
  if (group.joint_a[place] != nullptr || group.joint_b[place] != nullptr) group.has_joint = true;
}

void BodyRows::add(btPersistentManifold& manifold, int a, int b, const ContactGoals& goals,
                   const Bodies& bodies, const std::vector<bool>& touched) noexcept {
  // Of a tree of joints, the rigid body is the link that touches; `a` and `b` are the whole tree.
  const auto mover = [&](int body, const btCollisionObject* object) -> const btRigidBody* {
    const SolverJoint* on = jointOf(bodies[body]);
    const bool of_tree = on != nullptr && on->chain != nullptr;
    return of_tree ? tagOf(object)->rigid : bodies[body].m_originalBody;
  };
  const btRigidBody* rigid_a = mover(a, manifold.getBody0());
  const btRigidBody* rigid_b = mover(b, manifold.getBody1());
  if (rigid_a == nullptr && rigid_b == nullptr) return;
  const auto write = [](const btVector3& from, EachVector& to, int place) {
    for (int k = 0; k < 3; ++k) to[k][place] = from[k];
  };
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    btManifoldPoint& point = manifold.getContactPoint(k);
    if (point.getDistance() > manifold.getContactProcessingThreshold()) continue;
    // Puts the contact into a group of its depth.
    const int depth =
        std::max(rigid_a != nullptr ? depth_[a] : 0, rigid_b != nullptr ? depth_[b] : 0);
    depth_[a] = depth_[b] = depth + 1;
    Group& group = groupFor(2 * depth + (touched[a] || touched[b] ? 0 : 1));
    const int place = group.used++;
    put(group, place, a, b, rigid_a, rigid_b);
    group.point[place] = &point;
    group.friction[place] = point.m_combinedFriction;
    // Arms from the bodies' centres to the contact.
    const btVector3 none(0.0, 0.0, 0.0), &normal = point.m_normalWorldOnB;
    const auto arm = [&](const btRigidBody* rigid, const btVector3& at_m) {
      return rigid != nullptr ? at_m - rigid->getCenterOfMassPosition() : none;
    };
    const btVector3 arm_a = arm(rigid_a, point.getPositionWorldOnA());
    const btVector3 arm_b = arm(rigid_b, point.getPositionWorldOnB());
    write(arm_a, group.arm_a, place), write(arm_b, group.arm_b, place);
    // Goal velocity: the gap may close; an overlap is reduced; fast bodies bounce.
    const double apart_m = point.getDistance() + goals.slop_m;
    double goal = apart_m > 0.0
                      ? -apart_m / goals.step_s
                      : std::min(-apart_m * goals.erp / goals.step_s, goals.most_push_m_s);
    if (point.m_combinedRestitution > 0.0) {
      const btVector3 of_a = rigid_a != nullptr ? rigid_a->getVelocityInLocalPoint(arm_a) : none;
      const btVector3 of_b = rigid_b != nullptr ? rigid_b->getVelocityInLocalPoint(arm_b) : none;
      const double closing_m_s = normal.dot(of_b - of_a);
      if (closing_m_s >= goals.bounce_from_m_s) goal += point.m_combinedRestitution * closing_m_s;
    }
    group.goal[place] = goal;
    // Directions and starting impulses.
    btVector3 &tangent1 = point.m_lateralFrictionDir1, &tangent2 = point.m_lateralFrictionDir2;
    btPlaneSpace1(normal, tangent1, tangent2);
    write(normal, group.normal.along, place);
    write(tangent1, group.tangent1.along, place);
    write(tangent2, group.tangent2.along, place);
    group.normal.impulse[place] = goals.warm_start * point.m_appliedImpulse;
    group.tangent1.impulse[place] = goals.warm_start * point.m_appliedImpulseLateral1;
    group.tangent2.impulse[place] = goals.warm_start * point.m_appliedImpulseLateral2;
    near_uneven_ = near_uneven_ || ((touched[a] || touched[b]) && isUneven(group, place));
    ++contacts_;
  }
}

void BodyRows::begin(Bodies& bodies, const std::vector<bool>& touched) noexcept {
  if (!any()) return;
  backwards_ = false;
  for (int i = 0; i < bodies.size(); ++i) {
    copyVector(bodies[i].m_deltaLinearVelocity, motions_[i].linear);
    copyVector(bodies[i].m_deltaAngularVelocity, motions_[i].angular);
    takeState(bodies[i], states_[i].linear, states_[i].angular, states_[i].mobility);
    if (moves(bodies[i])) (touched[i] ? touched_ : free_).push_back(i);
  }
  // Sorts the groups by their runs, and so by depth.
  std::fill_n(first_.begin(), runs_ + 1, 0);
  for (int i = 0; i < group_count_; ++i) ++first_[groups_[i].run + 1];
  for (int run = 0; run < runs_; ++run) first_[run + 1] += first_[run];
  all_.resize(group_count_);
  for (int i = 0; i < group_count_; ++i) all_[first_[groups_[i].run]++] = &groups_[i];
  for (Group* group : all_) {
    if (group->run % 2 == 0) near_.push_back(group);
    for (int place = group->used; place < kWide; ++place) leaveEmpty(*group, place);
  }
  lay(all_);
  findIslands(bodies);
  shortenStart(bodies);
  for (const int i : touched_) {
    copyVector(motions_[i].linear, bodies[i].m_deltaLinearVelocity);
    copyVector(motions_[i].angular, bodies[i].m_deltaAngularVelocity);
  }
}

void BodyRows::write(Bodies& bodies) const noexcept {
  for (const int i : free_) {
    copyVector(motions_[i].linear, bodies[i].m_deltaLinearVelocity);
    copyVector(motions_[i].angular, bodies[i].m_deltaAngularVelocity);
  }
  for (const Group* group : all_) {
    for (int place = 0; place < group->used; ++place) {
      if (group->point[place] == nullptr) continue;  // solved directly
      btManifoldPoint& point = *group->point[place];
      point.m_appliedImpulse = group->normal.impulse[place];
      point.m_appliedImpulseLateral1 = group->tangent1.impulse[place];
      point.m_appliedImpulseLateral2 = group->tangent2.impulse[place];
    }
  }
}

// Sets the normal impulses; a contact only pushes.
void BodyRows::press(Group& group, FourNumbers& most) {
  const FourNumbers none{};
  Row& row = group.normal;
  Velocities velocities;
  velocities.take(group);
  FourNumbers lacking, impulse;
  velocities.compare(row, lacking);
  load(impulse, row.impulse.data());
  const FourNumbers sum = impulse + lacking;
  const FourNumbers change = sum < none ? none - impulse : lacking;
  store(sum < none ? none : sum, row.impulse.data());
  velocities.apply(row, group, change);
  velocities.put(group);
  keepLargest(most, change);
}

// Sets the friction impulses; a contact without normal impulse has no friction.
void BodyRows::rub(Group& group, const FourNumbers& normal, FourNumbers& most) {
  Velocities velocities;
  velocities.take(group);
  FourNumbers lacking_1, lacking_2, limit;
  velocities.compare(group.tangent1, lacking_1);
  velocities.compare(group.tangent2, lacking_2);
  FrictionDisc<FourNumbers> disc;
  load(disc.yield_11, group.yield_11.data());
  load(disc.yield_12, group.yield_12.data());
  load(disc.yield_22, group.yield_22.data());
  load(disc.mass_11, group.mass_11.data());
  load(disc.mass_12, group.mass_12.data());
  load(disc.mass_22, group.mass_22.data());
  load(limit, group.friction.data());
  disc.limit = limit * normal;
  FourNumbers was_1, was_2, is_1, is_2;
  load(was_1, group.tangent1.impulse.data());
  load(was_2, group.tangent2.impulse.data());
  // The rows store impulses that alone would reach the target; the disc needs velocities.
  disc.solve(was_1, was_2, lacking_1 * disc.yield_11, lacking_2 * disc.yield_22, is_1, is_2);
  const FourNumbers change_1 = is_1 - was_1, change_2 = is_2 - was_2;
  store(is_1, group.tangent1.impulse.data());
  store(is_2, group.tangent2.impulse.data());
  velocities.apply(group.tangent1, group, change_1);
  velocities.apply(group.tangent2, group, change_2);
  velocities.put(group);
  keepLargest(most, change_1);
  keepLargest(most, change_2);
}

WHOLEHAND_VECTOR_CLONES double BodyRows::sweep(const std::vector<Group*>& groups, bool backwards,
                                               double& pressed) noexcept {
  FourNumbers most{}, largest{};
  const int count = static_cast<int>(groups.size());
  const int first = backwards ? count - 1 : 0, step = backwards ? -1 : 1;
  for (int i = 0, at = first; i < count; ++i, at += step) press(*groups[at], most);
  for (Group* group : groups) {
    FourNumbers normal;
    load(normal, group->normal.impulse.data());
    keepLargest(largest, normal);
    const auto rubs = [&](const Row& row) {
      FourNumbers impulse;
      load(impulse, row.impulse.data());
      return anyOf(impulse != FourNumbers{});
    };
    if (anyOf(normal > FourNumbers{}) || rubs(group->tangent1) || rubs(group->tangent2)) {
      rub(*group, normal, most);
    }
  }
  pressed = std::max(std::max(largest[0], largest[1]), std::max(largest[2], largest[3]));
  return std::max(std::max(most[0], most[1]), std::max(most[2], most[3]));
}

double BodyRows::sweep(Bodies& bodies, const std::vector<Group*>& groups) noexcept {
  if (groups.empty()) return 0.0;
  for (const int i : touched_) {
    copyVector(bodies[i].m_deltaLinearVelocity, motions_[i].linear);
    copyVector(bodies[i].m_deltaAngularVelocity, motions_[i].angular);
  }
  const double most = sweep(groups, backwards_, pressed_);
  backwards_ = !backwards_;
  for (const int i : touched_) {
    copyVector(motions_[i].linear, bodies[i].m_deltaLinearVelocity);
    copyVector(motions_[i].angular, bodies[i].m_deltaAngularVelocity);
  }
  return most;
}

double BodyRows::sweepAll(Bodies& bodies) noexcept {
  return sweep(bodies, all_);
}

double BodyRows::sweepNear(Bodies& bodies) noexcept {
  return sweep(bodies, near_);
}

bool BodyRows::isUneven(const Group& group, int place) noexcept {
  const double a = group.inverse_mass_a[place], b = group.inverse_mass_b[place];
  return std::min(a, b) > 0.0 && std::max(a, b) > kUneven * std::min(a, b);
}

}  // namespace wholehand::bullet
