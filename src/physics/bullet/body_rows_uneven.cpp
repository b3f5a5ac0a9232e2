#include "physics/bullet/body_rows.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <numeric>

// Heavy bodies on light ones, solved at once by ConeNewton: sweeps pass a load on from contact to
// contact, and need the more of them the heavier what lies above.

namespace wholehand::bullet {
namespace {

constexpr double kUneven = 10.0;  // ratio of two masses
// Per mobility of a row, which is that of the lighter body: at 1e-3 a ratio of 10,000 sinks in. One
// after the other: which contacts hold and stick is found where they are soft.
constexpr std::array kSoftness{1e-2, 1e-3, 1e-4, 1e-5};

// Of factorisations in a step of the world, each of the cube of the island's bodies: 16 of eight.
constexpr int kMostWork = 16 * 8 * 8 * 8;

}  // namespace

bool BodyRows::isUneven(const Group& group, int place) noexcept {
  const double a = group.inverse_mass_a[place], b = group.inverse_mass_b[place];
  return std::min(a, b) > 0.0 && std::max(a, b) > kUneven * std::min(a, b);
}

int BodyRows::islandOf(int body) noexcept {
  while (island_[body] != body) body = island_[body] = island_[island_[body]];
  return body;
}

// Movable bodies that touch are of one island.
void BodyRows::findIslands(const Bodies& bodies) noexcept {
  std::iota(island_.begin(), island_.begin() + bodies.size(), 0);
  std::fill_n(solved_at_once_.begin(), bodies.size(), false);
  for (const Group* group : all_) {
    for (int k = 0; k < group->used; ++k) {
      const int a = static_cast<int>(group->a[k] - motions_.data());
      const int b = static_cast<int>(group->b[k] - motions_.data());
      if (bodies[a].m_originalBody != nullptr && bodies[b].m_originalBody != nullptr) {
        island_[islandOf(a)] = islandOf(b);
      }
    }
  }
  for (const Group* group : all_) {
    for (int k = 0; k < group->used; ++k) {
      if (!isUneven(*group, k)) continue;
      solved_at_once_[islandOf(static_cast<int>(group->a[k] - motions_.data()))] = true;
    }
  }
  for (const int body : touched_) solved_at_once_[islandOf(body)] = false;
}

// @return false: more bodies or contacts than are solved at once
bool BodyRows::listIsland(int island, const Bodies& bodies) noexcept {
  member_count_ = place_count_ = 0;
  std::fill_n(slot_.begin(), bodies.size(), -1);
  for (const int body : free_) {
    if (islandOf(body) != island) continue;
    if (member_count_ == kMostUneven) return false;
    slot_[body] = member_count_;
    members_[member_count_] = body;
    const btRigidBody& rigid = *bodies[body].m_originalBody;
    IslandBody& added = roots_[member_count_++];
    added.linear = std::sqrt(rigid.getInvMass());
    const btMatrix3x3& inverse = rigid.getInvInertiaTensorWorld();
    added.angular.factorize([&](int r, int c) { return inverse[r][c]; }, 3);
  }
  for (Group* group : all_) {
    for (int k = 0; k < group->used; ++k) {
      if (slot_[group->a[k] - motions_.data()] < 0 && slot_[group->b[k] - motions_.data()] < 0) {
        continue;
      }
      if (place_count_ == static_cast<int>(places_.size())) return false;
      places_[place_count_++] = {group, k};
    }
  }
  return true;
}

void BodyRows::writeRow(const Row& row, const Place& at, ConeNewton::Row& out) const noexcept {
  const int k = at.place;
  const auto one_side = [&](const Motion* motion, const EachVector& about, double sign) {
    const int slot = slot_[motion - motions_.data()];
    if (slot < 0) return;
    const IslandBody& of = roots_[slot];
    double* along = out.along.data() + 6 * slot;
    for (int i = 0; i < 3; ++i) along[i] = sign * of.linear * row.along[i][k];
    const std::array<double, 3> turns{about[0][k], about[1][k], about[2][k]};
    of.angular.transpose(turns.data(), along + 3);
  };
  one_side(at.group->a[k], row.about_a, 1.0);
  one_side(at.group->b[k], row.about_b, -1.0);
  out.goal = row.effective_mass[k] > 0.0 ? row.target[k] / row.effective_mass[k] : 0.0;
}

bool BodyRows::solveIsland(ConeNewton& newton, int most_steps) noexcept {
  newton.begin(6 * member_count_, kSoftness.front(), most_steps);
  for (int i = 0; i < place_count_; ++i) {
    const Place& at = places_[i];
    const btManifoldPoint& point = *at.group->point[at.place];
    ConeNewton::Row* rows = newton.add(3, at.group->friction[at.place], 0.0);
    if (rows == nullptr) return false;
    writeRow(at.group->normal, at, rows[0]);
    writeRow(at.group->tangent1, at, rows[1]);
    writeRow(at.group->tangent2, at, rows[2]);
    // What the last step ended with, whole: the solution is exact where nothing changes.
    rows[0].start = point.m_appliedImpulse;
    rows[1].start = point.m_appliedImpulseLateral1;
    rows[2].start = point.m_appliedImpulseLateral2;
  }
  bool found = newton.solve();
  for (std::size_t i = 1; found; ++i) {
    takeImpulses(newton);
    if (i == kSoftness.size()) return true;
    found = newton.solveAgain(kSoftness[i]);
  }
  return false;
}

void BodyRows::takeImpulses(const ConeNewton& newton) noexcept {
  for (int i = 0; i < place_count_; ++i) {
    Group& group = *places_[i].group;
    const int k = places_[i].place;
    group.normal.impulse[k] = newton.row(3 * i).impulse;
    group.tangent1.impulse[k] = newton.row(3 * i + 1).impulse;
    group.tangent2.impulse[k] = newton.row(3 * i + 2).impulse;
  }
  for (int m = 0; m < member_count_; ++m) {
    const double* change = newton.change().data() + 6 * m;
    Motion& motion = motions_[members_[m]];
    for (int i = 0; i < 3; ++i) motion.linear[i] = roots_[m].linear * change[i];
    roots_[m].angular.apply(change + 3, motion.angular.data());
  }
}

bool BodyRows::solveUneven(ConeNewton& newton, const Bodies& bodies) noexcept {
  if (!uneven_) return false;
  bool solved = true;
  findIslands(bodies);
  int work = kMostWork;
  for (const int body : free_) {
    if (islandOf(body) != body || !solved_at_once_[body]) continue;
    if (!listIsland(body, bodies)) {
      solved = false;
      continue;
    }
    const int of_a_step = member_count_ * member_count_ * member_count_;
    solved = solveIsland(newton, work / of_a_step) && solved;
    work = newton.stepsLeft() * of_a_step;
  }
  return solved;
}

}  // namespace wholehand::bullet
