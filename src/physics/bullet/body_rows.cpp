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

void BodyRows::copy(const btSolverConstraint& from, bool a_moves, Row& to, int place) noexcept {
  const btVector3& along = a_moves ? from.m_contactNormal1 : from.m_contactNormal2;
  for (int k = 0; k < 3; ++k) {
    to.along[k][place] = a_moves ? along[k] : -along[k];
    to.about_a[k][place] = from.m_relpos1CrossNormal[k];
    to.about_b[k][place] = from.m_relpos2CrossNormal[k];
    to.response_a[k][place] = from.m_angularComponentA[k];
    to.response_b[k][place] = from.m_angularComponentB[k];
  }
  to.target[place] = from.m_rhs;
  to.effective_mass[place] = from.m_jacDiagABInv;
  to.impulse[place] = from.m_appliedImpulse;
}

// A place without contact: its bodies are none, its rows zero.
void BodyRows::leaveEmpty(Group& group, int place) noexcept {
  static const btSolverConstraint kNone = [] {
    btSolverConstraint none;
    for (btVector3* vector :
         {&none.m_contactNormal1, &none.m_contactNormal2, &none.m_relpos1CrossNormal,
          &none.m_relpos2CrossNormal, &none.m_angularComponentA, &none.m_angularComponentB}) {
      vector->setZero();
    }
    none.m_rhs = none.m_jacDiagABInv = none.m_appliedImpulse = 0.0;
    return none;
  }();
  for (Row* row : {&group.normal, &group.tangent1, &group.tangent2}) copy(kNone, true, *row, place);
  group.a[place] = group.b[place] = &motions_.back();
  group.inverse_mass_a[place] = group.inverse_mass_b[place] = group.friction[place] = 0.0;
  group.yield_11[place] = group.yield_22[place] = group.mass_11[place] = group.mass_22[place] = 1.0;
  group.yield_12[place] = group.mass_12[place] = 0.0;
  group.point[place] = nullptr;
}

// Bullet made the rows for two free bodies.
void BodyRows::turnToJoints(Group& group, int place, btSolverBody& a, btSolverBody& b) noexcept {
  Row* const rows[] = {&group.normal, &group.tangent1, &group.tangent2};
  const auto vector = [place](const EachVector& each) {
    return btVector3(each[0][place], each[1][place], each[2][place]);
  };
  const auto one_side = [&](btSolverBody& body, EachVector Row::*about, EachVector Row::*response,
                            Each& inverse_mass, double sign) {
    const BodyJoint* joint = onJoint(body);
    if (joint == nullptr) return;
    inverse_mass[place] = 0.0;
    for (Row* row : rows) {
      btVector3 along = sign * vector(row->along), turns = vector(row->*about);
      projectOnJoint(*joint, along, turns);
      for (int k = 0; k < 3; ++k) {
        (row->*about)[k][place] = turns[k];
        (row->*response)[k][place] = joint->yield() * turns[k];
      }
      body.m_deltaAngularVelocity[0] += joint->yield() * turns.x() * row->impulse[place];
    }
  };
  one_side(a, &Row::about_a, &Row::response_a, group.inverse_mass_a, 1.0);
  one_side(b, &Row::about_b, &Row::response_b, group.inverse_mass_b, -1.0);
  const auto yield = [&](const Row& row, const Row& to) {
    return (group.inverse_mass_a[place] + group.inverse_mass_b[place]) *
               vector(row.along).dot(vector(to.along)) +
           vector(row.about_a).dot(vector(to.response_a)) +
           vector(row.about_b).dot(vector(to.response_b));
  };
  for (Row* row : rows) {
    const double mobility = yield(*row, *row);
    const double effective_mass = mobility > kLeastMobility ? 1.0 / mobility : 0.0;
    row->target[place] *= effective_mass / row->effective_mass[place];
    row->effective_mass[place] = effective_mass;
  }
  constexpr double kDefinite = 1.0 + 1e-9;  // where one joint alone moves both
  group.yield_11[place] = kDefinite * std::max(yield(*rows[1], *rows[1]), kLeastMobility);
  group.yield_22[place] = kDefinite * std::max(yield(*rows[2], *rows[2]), kLeastMobility);
  group.yield_12[place] = yield(*rows[1], *rows[2]);
}

void BodyRows::add(const btConstraintArray& normals, const btConstraintArray& frictions,
                   Bodies& bodies, const std::vector<bool>& touched) noexcept {
  for (int i = 0; i < normals.size(); ++i) {
    const btSolverConstraint& normal = normals[i];
    const btSolverConstraint& tangent = frictions[normal.m_frictionIndex];
    const int a = normal.m_solverBodyIdA, b = normal.m_solverBodyIdB;
    const bool a_moves = moves(bodies[a]), b_moves = moves(bodies[b]);
    const int depth = std::max(a_moves ? depth_[a] : 0, b_moves ? depth_[b] : 0);
    depth_[a] = depth_[b] = depth + 1;
    Group& group = groupFor(2 * depth + (touched[a] || touched[b] ? 0 : 1));
    const int place = group.used++;
    group.point[place] = static_cast<btManifoldPoint*>(normal.m_originalContactPoint);
    group.a[place] = &motions_[a];
    group.b[place] = &motions_[b];
    group.inverse_mass_a[place] = bodies[a].m_invMass.x();
    group.inverse_mass_b[place] = bodies[b].m_invMass.x();
    group.friction[place] = tangent.m_friction;
    copy(normal, a_moves, group.normal, place);
    copy(tangent, a_moves, group.tangent1, place);
    const btSolverConstraint& other = frictions[normal.m_frictionIndex + 1];
    copy(other, a_moves, group.tangent2, place);
    group.yield_11[place] = 1.0 / tangent.m_jacDiagABInv;
    group.yield_22[place] = 1.0 / other.m_jacDiagABInv;
    group.yield_12[place] = tangent.m_relpos1CrossNormal.dot(other.m_angularComponentA) +
                            tangent.m_relpos2CrossNormal.dot(other.m_angularComponentB);
    if (onJoint(bodies[a]) != nullptr || onJoint(bodies[b]) != nullptr) {
      turnToJoints(group, place, bodies[a], bodies[b]);
    }
    const double det = group.yield_11[place] * group.yield_22[place] -
                       group.yield_12[place] * group.yield_12[place];
    group.mass_11[place] = group.yield_22[place] / det;
    group.mass_12[place] = -group.yield_12[place] / det;
    group.mass_22[place] = group.yield_11[place] / det;
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
