#include "physics/bullet/body_rows.hpp"

#include "core/vector_clones.hpp"
#include "physics/bullet/friction_disc.hpp"
#include "physics/bullet/joint_rows.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

namespace wholehand::bullet {
namespace {

// What moves less than this by an impulse moves nothing: what pushes a hinge's axis [1/kg].
constexpr double kLeastMobility = 1e-12;

bool moves(const btSolverBody& body) {
  return body.m_originalBody != nullptr;
}

/// The joint of a body; null: it is free, or fixed.
const BodyJoint* onJoint(const btSolverBody& body) {
  return moves(body) ? jointOf(*body.m_originalBody) : nullptr;
}

void copyVector(const btVector3& from, std::array<double, 4>& to) {
  to = {from.x(), from.y(), from.z(), 0.0};
}

void copyVector(const std::array<double, 4>& from, btVector3& to) {
  to.setValue(from[0], from[1], from[2]);
}

/// A vector of each of four contacts.
struct FourVectors {
  FourNumbers x, y, z;
};

[[gnu::always_inline]] inline void loadVectors(FourVectors& to,
                                               const std::array<std::array<double, 4>, 3>& from) {
  load(to.x, from[0].data());
  load(to.y, from[1].data());
  load(to.z, from[2].data());
}

/// From four vectors with a fourth number each.
[[gnu::always_inline]] inline void gather(FourVectors& to, const double* of_0, const double* of_1,
                                          const double* of_2, const double* of_3) {
  FourNumbers v0, v1, v2, v3;
  load(v0, of_0), load(v1, of_1), load(v2, of_2), load(v3, of_3);
  const FourNumbers xz01 = __builtin_shufflevector(v0, v1, 0, 4, 2, 6);
  const FourNumbers yw01 = __builtin_shufflevector(v0, v1, 1, 5, 3, 7);
  const FourNumbers xz23 = __builtin_shufflevector(v2, v3, 0, 4, 2, 6);
  const FourNumbers yw23 = __builtin_shufflevector(v2, v3, 1, 5, 3, 7);
  to.x = __builtin_shufflevector(xz01, xz23, 0, 1, 4, 5);
  to.y = __builtin_shufflevector(yw01, yw23, 0, 1, 4, 5);
  to.z = __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7);
}

/// The opposite; the fourth numbers become zero.
[[gnu::always_inline]] inline void scatter(const FourVectors& from, double* to_0, double* to_1,
                                           double* to_2, double* to_3) {
  const FourNumbers none{};
  const FourNumbers xy02 = __builtin_shufflevector(from.x, from.y, 0, 4, 2, 6);
  const FourNumbers xy13 = __builtin_shufflevector(from.x, from.y, 1, 5, 3, 7);
  const FourNumbers z02 = __builtin_shufflevector(from.z, none, 0, 4, 2, 6);
  const FourNumbers z13 = __builtin_shufflevector(from.z, none, 1, 5, 3, 7);
  store(__builtin_shufflevector(xy02, z02, 0, 1, 4, 5), to_0);
  store(__builtin_shufflevector(xy13, z13, 0, 1, 4, 5), to_1);
  store(__builtin_shufflevector(xy02, z02, 2, 3, 6, 7), to_2);
  store(__builtin_shufflevector(xy13, z13, 2, 3, 6, 7), to_3);
}

/// to = a·b, in Bullet's order
[[gnu::always_inline]] inline void dot(FourNumbers& to, const FourVectors& a,
                                       const FourVectors& b) {
  to = a.x * b.x + a.y * b.y + a.z * b.z;
}

/// to += factor · vector
[[gnu::always_inline]] inline void addScaled(FourVectors& to, const FourNumbers& factor,
                                             const FourVectors& vector) {
  to.x += vector.x * factor;
  to.y += vector.y * factor;
  to.z += vector.z * factor;
}

/// @param which of a comparison
template <class Mask>
[[gnu::always_inline]] inline bool anyOf(const Mask& which) {
  return ((which[0] | which[1]) | (which[2] | which[3])) != 0;
}

[[gnu::always_inline]] inline void keepLargest(FourNumbers& most, const FourNumbers& change) {
  most = change > most ? change : most;
  most = -change > most ? -change : most;
}

}  // namespace

/// Of the bodies of a group's contacts.
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

  /// As Bullet's resolveSingleConstraintRowGeneric(): what is lacking of the row's impulse.
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
      depth_(bodies),
      open_(2 * contacts),
      first_(2 * contacts + 1),
      island_(bodies),
      solved_at_once_(bodies),
      slot_(bodies) {
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
  if (any()) std::fill(depth_.begin(), depth_.end(), 0);
  contacts_ = group_count_ = runs_ = 0;
  uneven_ = false;
}

BodyRows::Group& BodyRows::groupFor(int run) noexcept {
  for (; runs_ <= run; ++runs_) open_[runs_] = nullptr;
  Group*& open = open_[run];
  if (open == nullptr) {
    open = &groups_[group_count_++];
    open->run = run;
    open->used = 0;
  }
  Group& group = *open;
  if (group.used == kWide - 1) open = nullptr;
  return group;
}

// A place without contact: its bodies are none, its rows zero.
void BodyRows::leaveEmpty(Group& group, int place) noexcept {
  for (Row* row : {&group.normal, &group.tangent1, &group.tangent2}) {
    for (EachVector* vector :
         {&row->along, &row->about_a, &row->about_b, &row->response_a, &row->response_b}) {
      for (Each& each : *vector) each[place] = 0.0;
    }
    row->target[place] = row->effective_mass[place] = row->impulse[place] = 0.0;
  }
  group.a[place] = group.b[place] = &motions_.back();
  group.inverse_mass_a[place] = group.inverse_mass_b[place] = group.friction[place] = 0.0;
  group.yield_11[place] = group.yield_22[place] = group.mass_11[place] = group.mass_22[place] = 1.0;
  group.yield_12[place] = group.mass_12[place] = 0.0;
  group.point[place] = nullptr;
}

/// A body at a contact.
struct BodyRows::Side {
  btSolverBody& body;
  const btRigidBody* rigid;  ///< null: it stands
  const BodyJoint* joint;    ///< null: it is free
  btVector3 arm_m;           ///< from its centre
  double inverse_mass = 0.0;

  Side(btSolverBody& of, const btVector3& at_m)
      : body(of), rigid(of.m_originalBody), joint(onJoint(of)), arm_m(0.0, 0.0, 0.0) {
    if (rigid == nullptr) return;
    arm_m = at_m - rigid->getCenterOfMassPosition();
    if (joint == nullptr) inverse_mass = rigid->getInvMass();
  }

  /// What an impulse along a direction turns, and the change of the angular velocity by it.
  void turn(const btVector3& along, btVector3& about, btVector3& response) const {
    about.setZero(), response.setZero();
    if (rigid == nullptr) return;
    about = arm_m.cross(along);
    if (joint == nullptr) {
      response = rigid->getInvInertiaTensorWorld() * about;
      return;
    }
    btVector3 linear = along;
    projectOnJoint(*joint, linear, about);
    response = joint->yield() * about;
  }

  /// Velocity along a direction without contacts.
  [[nodiscard]] double rate(const btVector3& along, const btVector3& about) const {
    if (rigid == nullptr) return 0.0;
    if (joint != nullptr) return about.x() * joint->rate();
    return along.dot(body.m_linearVelocity + body.m_externalForceImpulse) +
           about.dot(body.m_angularVelocity + body.m_externalTorqueImpulse);
  }

  /// The same before what forces change in this step.
  [[nodiscard]] double rateBefore(const btVector3& along) const {
    if (rigid == nullptr) return 0.0;
    return along.dot(rigid->getVelocityInLocalPoint(arm_m));
  }
};

/// Lays a row, and lets its starting impulse act. @return its velocity per impulse
double BodyRows::layRow(const btVector3& along, const Side& a, const Side& b, double goal,
                        double start, Row& row, int place) noexcept {
  const btVector3 opposite = -along;
  btVector3 about_a, about_b, response_a, response_b;
  a.turn(along, about_a, response_a);
  b.turn(opposite, about_b, response_b);
  const double yield =
      a.inverse_mass + b.inverse_mass + about_a.dot(response_a) + about_b.dot(response_b);
  for (int k = 0; k < 3; ++k) {
    row.along[k][place] = along[k];
    row.about_a[k][place] = about_a[k];
    row.about_b[k][place] = about_b[k];
    row.response_a[k][place] = response_a[k];
    row.response_b[k][place] = response_b[k];
  }
  row.effective_mass[place] = yield > kLeastMobility ? 1.0 / yield : 0.0;
  row.target[place] =
      (goal - a.rate(along, about_a) - b.rate(opposite, about_b)) * row.effective_mass[place];
  row.impulse[place] = start;
  if (start != 0.0) {
    a.body.m_deltaLinearVelocity += along * (a.inverse_mass * start);
    a.body.m_deltaAngularVelocity += response_a * start;
    b.body.m_deltaLinearVelocity += opposite * (b.inverse_mass * start);
    b.body.m_deltaAngularVelocity += response_b * start;
  }
  return yield;
}

void BodyRows::addPoint(btManifoldPoint& point, const ContactGoals& goals, btSolverBody& on_a,
                        btSolverBody& on_b, Group& group, int place) noexcept {
  const Side a(on_a, point.getPositionWorldOnA()), b(on_b, point.getPositionWorldOnB());
  group.inverse_mass_a[place] = a.inverse_mass;
  group.inverse_mass_b[place] = b.inverse_mass;
  group.friction[place] = point.m_combinedFriction;
  group.point[place] = &point;
  const btVector3& normal = point.m_normalWorldOnB;
  const double apart_m = point.getDistance() + goals.slop_m;
  double goal = apart_m > 0.0 ? -apart_m / goals.step_s : -apart_m * goals.erp / goals.step_s;
  if (point.m_combinedRestitution > 0.0) {
    const double closing_m_s = -a.rateBefore(normal) + b.rateBefore(normal);
    if (closing_m_s >= goals.bounce_from_m_s) goal += point.m_combinedRestitution * closing_m_s;
  }
  (void)layRow(normal, a, b, goal, goals.warm_start * point.m_appliedImpulse, group.normal, place);
  btVector3 &tangent1 = point.m_lateralFrictionDir1, &tangent2 = point.m_lateralFrictionDir2;
  btPlaneSpace1(normal, tangent1, tangent2);
  double yield_11 = layRow(tangent1, a, b, 0.0, goals.warm_start * point.m_appliedImpulseLateral1,
                           group.tangent1, place);
  double yield_22 = layRow(tangent2, a, b, 0.0, goals.warm_start * point.m_appliedImpulseLateral2,
                           group.tangent2, place);
  double yield_12 = 0.0;
  const Row &one = group.tangent1, &two = group.tangent2;
  for (int k = 0; k < 3; ++k) {
    yield_12 += one.about_a[k][place] * two.response_a[k][place] +
                one.about_b[k][place] * two.response_b[k][place];
  }
  if (a.joint != nullptr || b.joint != nullptr) {
    constexpr double kDefinite = 1.0 + 1e-9;  // where one joint alone moves both
    yield_11 = kDefinite * std::max(yield_11, kLeastMobility);
    yield_22 = kDefinite * std::max(yield_22, kLeastMobility);
  }
  const double det = yield_11 * yield_22 - yield_12 * yield_12;
  group.yield_11[place] = yield_11;
  group.yield_12[place] = yield_12;
  group.yield_22[place] = yield_22;
  group.mass_11[place] = yield_22 / det;
  group.mass_12[place] = -yield_12 / det;
  group.mass_22[place] = yield_11 / det;
}

void BodyRows::add(btPersistentManifold& manifold, int a, int b, const ContactGoals& goals,
                   Bodies& bodies, const std::vector<bool>& touched) noexcept {
  const bool a_moves = moves(bodies[a]), b_moves = moves(bodies[b]);
  if (!a_moves && !b_moves) return;
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    btManifoldPoint& point = manifold.getContactPoint(k);
    if (point.getDistance() > manifold.getContactProcessingThreshold()) continue;
    const int depth = std::max(a_moves ? depth_[a] : 0, b_moves ? depth_[b] : 0);
    depth_[a] = depth_[b] = depth + 1;
    Group& group = groupFor(2 * depth + (touched[a] || touched[b] ? 0 : 1));
    const int place = group.used++;
    group.a[place] = &motions_[a];
    group.b[place] = &motions_[b];
    addPoint(point, goals, bodies[a], bodies[b], group, place);
    uneven_ = uneven_ || isUneven(group, place);
    ++contacts_;
  }
}

void BodyRows::begin(const Bodies& bodies, const std::vector<bool>& touched) noexcept {
  if (!any()) return;
  backwards_ = false;
  for (int i = 0; i < bodies.size(); ++i) {
    copyVector(bodies[i].m_deltaLinearVelocity, motions_[i].linear);
    copyVector(bodies[i].m_deltaAngularVelocity, motions_[i].angular);
    if (moves(bodies[i])) (touched[i] ? touched_ : free_).push_back(i);
  }
  // The groups by their runs, which is by depth.
  std::fill_n(first_.begin(), runs_ + 1, 0);
  for (int i = 0; i < group_count_; ++i) ++first_[groups_[i].run + 1];
  for (int run = 0; run < runs_; ++run) first_[run + 1] += first_[run];
  all_.resize(group_count_);
  for (int i = 0; i < group_count_; ++i) all_[first_[groups_[i].run]++] = &groups_[i];
  for (Group* group : all_) {
    if (group->run % 2 == 0) near_.push_back(group);
    for (int place = group->used; place < kWide; ++place) leaveEmpty(*group, place);
  }
}

void BodyRows::write(Bodies& bodies) const noexcept {
  for (const int i : free_) {
    copyVector(motions_[i].linear, bodies[i].m_deltaLinearVelocity);
    copyVector(motions_[i].angular, bodies[i].m_deltaAngularVelocity);
  }
  for (const Group* group : all_) {
    for (int place = 0; place < group->used; ++place) {
      btManifoldPoint& point = *group->point[place];
      point.m_appliedImpulse = group->normal.impulse[place];
      point.m_appliedImpulseLateral1 = group->tangent1.impulse[place];
      point.m_appliedImpulseLateral2 = group->tangent2.impulse[place];
    }
  }
}

// Sets the normal impulses. A contact only pushes.
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

// Sets the impulses of friction. What nothing presses does not rub.
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
  // The rows' units are impulses that alone would reach the target.
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

}  // namespace wholehand::bullet
