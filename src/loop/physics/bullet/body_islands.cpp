#include "loop/physics/bullet/body_rows.hpp"
#include "loop/physics/bullet/free_motion.hpp"
#include "loop/physics/bullet/joint_rows.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>
#include <numeric>

// IslandNewton solves islands directly. Sweeps carry a load from contact to contact: the heavier
// the body above is, the more of them it takes.

namespace wholehand::bullet {
namespace {

// Largest work for factorisations in a step of the world, in products of blocks.
constexpr int kMostWork = 4000;
constexpr int kMostSteps = 40;          // factorisations of an island
constexpr int kMostCoupledSteps = 120;  // of one with the hand, altogether
}  // namespace

int BodyRows::islandOf(int body) noexcept {
  while (island_[body] != body) body = island_[body] = island_[island_[body]];
  return body;
}

int BodyRows::moverOf(const Group& group, int place) const noexcept {
  const bool a_moves = group.inverse_mass_a[place] > 0.0 || group.joint_a[place] != nullptr;
  return static_cast<int>((a_moves ? group.a[place] : group.b[place]) - motions_.data());
}

// Finds the islands: movable bodies that touch belong to the same island.
void BodyRows::findIslands(const Bodies& bodies) noexcept {
  std::iota(island_.begin(), island_.begin() + bodies.size(), 0);
  for (const Group* group : all_) {
    for (int k = 0; k < group->used; ++k) {
      const int a = static_cast<int>(group->a[k] - motions_.data());
      const int b = static_cast<int>(group->b[k] - motions_.data());
      if (bodies[a].m_originalBody != nullptr && bodies[b].m_originalBody != nullptr) {
        island_[islandOf(a)] = islandOf(b);
      }
    }
  }
}

// Shortens the starting impulses. Those of the last step may come from an impact; applied again
// they would throw light bodies faster than the sweeps can stop them. With J v the rows' velocities
// before contacts and g their goals, each sweep lowers f(r) = ½ (Jᵀr)ᵀ M⁻¹ (Jᵀr) + rᵀ(J v − g): the
// kinetic energy given minus the energy that the goals ask for. f = 0 without impulses. An island
// whose impulses r have f > 0 starts from the share of r with the least f.
void BodyRows::shortenStart(const Bodies& bodies) noexcept {
  std::fill_n(start_.begin(), bodies.size(), Start{});
  for (const Group* group : all_) {
    for (int k = 0; k < group->used; ++k) {
      // Sums the energy that the goals ask for.
      double& gain_j = start_[islandOf(moverOf(*group, k))].gain_j;
      for (const Row* row : {&group->normal, &group->tangent1, &group->tangent2}) {
        if (row->effective_mass[k] == 0.0) continue;
        gain_j += row->impulse[k] * row->target[k] / row->effective_mass[k];
      }
    }
  }
  for (const int i : free_) {
    const auto vector = [](const std::array<double, 4>& of) {
      return btVector3(of[0], of[1], of[2]);
    };
    start_[islandOf(i)].cost_j += kineticEnergy(
        *bodies[i].m_originalBody, vector(motions_[i].linear), vector(motions_[i].angular));
  }
  // The rows do not include the hand's action on an island, so islands that the hand touches keep
  // their impulses.
  for (const int i : touched_) start_[islandOf(i)].cost_j = 0.0;
  bool all_whole = true;
  for (int i = 0; i < bodies.size(); ++i) {
    Start& of = start_[i];
    if (of.cost_j <= std::max(of.gain_j, 0.0)) continue;
    of.share = std::max(0.0, 0.5 * of.gain_j / of.cost_j);
    all_whole = false;
  }
  if (all_whole) return;
  for (const int i : free_) {
    const double share = start_[islandOf(i)].share;
    for (double& number : motions_[i].linear) number *= share;
    for (double& number : motions_[i].angular) number *= share;
  }
  for (Group* group : all_) {
    for (int k = 0; k < group->used; ++k) {
      const double share = start_[islandOf(moverOf(*group, k))].share;
      for (Row* row : {&group->normal, &group->tangent1, &group->tangent2}) {
        row->impulse[k] *= share;
      }
    }
  }
}

// Sorts bodies and contacts by their islands; both keep their order.
void BodyRows::sortByIsland(const Bodies& bodies, const std::vector<bool>& by_hand) noexcept {
  const int count = bodies.size();
  std::fill_n(swept_.begin(), count, 0);
  for (const int body : touched_) {
    if (by_hand[body]) swept_[islandOf(body)] = 1;
  }
  std::fill_n(first_body_.begin(), count + 1, 0);
  std::fill_n(first_place_.begin(), count + 1, 0);
  for (int body = 0; body < count; ++body) {
    if (moves(bodies[body])) ++first_body_[islandOf(body) + 1];
  }
  for (const Group* group : all_) {
    for (int k = 0; k < group->used; ++k) ++first_place_[islandOf(moverOf(*group, k)) + 1];
  }
  std::partial_sum(first_body_.begin(), first_body_.begin() + count + 1, first_body_.begin());
  std::partial_sum(first_place_.begin(), first_place_.begin() + count + 1, first_place_.begin());
  // Filling moves each island's first index to the end of the island, the first of the next one.
  for (int body = 0; body < count; ++body) {
    if (moves(bodies[body])) members_[first_body_[islandOf(body)]++] = body;
  }
  for (Group* group : all_) {
    for (int k = 0; k < group->used; ++k) {
      places_[first_place_[islandOf(moverOf(*group, k))]++] = {group, k};
    }
  }
  for (int i = count; i > 0; --i) {
    first_body_[i] = first_body_[i - 1];
    first_place_[i] = first_place_[i - 1];
  }
  first_body_[0] = first_place_[0] = 0;
}

void BodyRows::writeRow(const Row& row, const Place& at, int r,
                        IslandNewton::Contact& out) const noexcept {
  const int k = at.place;
  const auto one_side = [&](int slot, const EachVector& about, double sign,
                            IslandNewton::Six& along) {
    if (slot < 0) return;
    const IslandBody& of = roots_[slot];
    for (int i = 0; i < 3; ++i) along[i] = sign * of.linear * row.along[i][k];
    const std::array<double, 3> turns{about[0][k], about[1][k], about[2][k]};
    of.angular.transpose(turns.data(), along.data() + 3);
  };
  one_side(out.a, row.about_a, 1.0, out.along_a[r]);
  one_side(out.b, row.about_b, -1.0, out.along_b[r]);
  out.goal[r] = row.effective_mass[k] > 0.0 ? row.target[k] / row.effective_mass[k] : 0.0;
}

// The velocities that the hand's impulses give belong to the present ones.
void BodyRows::subtractHand(const Place& at, IslandNewton::Contact& contact) const noexcept {
  const Group& group = *at.group;
  const Motion &a = hand_[group.a[at.place] - motions_.data()],
               &b = hand_[group.b[at.place] - motions_.data()];
  int r = 0;
  for (const Row* row : {&group.normal, &group.tangent1, &group.tangent2}) {
    for (int i = 0; i < 3; ++i) {
      contact.goal[r] -= row->along[i][at.place] * (a.linear[i] - b.linear[i]) +
                         row->about_a[i][at.place] * a.angular[i] +
                         row->about_b[i][at.place] * b.angular[i];
    }
    ++r;
  }
}

void BodyRows::beginIsland(int island, const Bodies& bodies, int further) noexcept {
  const int first_body = first_body_[island], first_place = first_place_[island];
  const int body_count = first_body_[island + 1] - first_body;
  for (int i = 0; i < body_count; ++i) {
    const int body = members_[first_body + i];
    slot_[body] = i;
    const Mobility mobility = mobilityOf(*bodies[body].m_originalBody);
    roots_[i].linear = std::sqrt(mobility.linear);
    roots_[i].angular.factorize([&](int r, int c) { return mobility.angular[r][c]; }, 3);
  }
  newton_.begin(body_count + further);
  for (int i = first_place; i < first_place_[island + 1]; ++i) {
    const Place& at = places_[i];
    const auto slot_of = [&](const Motion* motion) {
      const auto body = motion - motions_.data();
      return bodies[static_cast<int>(body)].m_originalBody != nullptr ? slot_[body] : -1;
    };
    IslandNewton::Contact& contact =
        *newton_.add(slot_of(at.group->a[at.place]), slot_of(at.group->b[at.place]));
    contact.friction = at.group->friction[at.place];
    writeRow(at.group->normal, at, 0, contact);
    writeRow(at.group->tangent1, at, 1, contact);
    writeRow(at.group->tangent2, at, 2, contact);
  }
}

bool BodyRows::fits(int island, int further) const noexcept {
  return first_body_[island + 1] - first_body_[island] + further <= IslandNewton::kMostBodies &&
         first_place_[island + 1] - first_place_[island] <= IslandNewton::kMostContacts;
}

bool BodyRows::solveBegun() noexcept {
  const int of_a_step = newton_.order();
  if (of_a_step == 0) return false;
  const int most = work_ / of_a_step;
  const bool found = newton_.solve(std::min(kMostSteps, most), std::min(kMostCoupledSteps, most));
  work_ -= of_a_step * newton_.steps();
  return found;
}

// Starts from the impulses of the last step, reduced if they came from an impact (shortenStart()).
bool BodyRows::solveIsland(int island, const Bodies& bodies, JointRows& joints) noexcept {
  if (!fits(island, 0)) return false;
  beginIsland(island, bodies, 0);
  const double share = start_[island].share;
  for (int i = 0; i < newton_.contactCount(); ++i) {
    const Place& at = places_[first_place_[island] + i];
    const btManifoldPoint& point = *at.group->point[at.place];
    newton_.contact(i).start = {share * point.m_appliedImpulse,
                                share * point.m_appliedImpulseLateral1,
                                share * point.m_appliedImpulseLateral2};
  }
  for (int i = first_body_[island]; i < first_body_[island + 1]; ++i) {
    if (!joints.addTo(newton_, members_[i], i - first_body_[island])) return false;
  }
  return solveBegun();
}

// Starts from the impulses of the sweeps.
void BodyRows::beginTouched(int island, const Bodies& bodies, int further) noexcept {
  beginIsland(island, bodies, further);
  for (int i = 0; i < newton_.contactCount(); ++i) {
    const Place& at = places_[first_place_[island] + i];
    newton_.contact(i).start = {at.group->normal.impulse[at.place],
                                at.group->tangent1.impulse[at.place],
                                at.group->tangent2.impulse[at.place]};
  }
}

int BodyRows::beginWithHand(int island, const Bodies& bodies) noexcept {
  if (!fits(island, 1)) return -1;
  beginTouched(island, bodies, 1);
  return first_body_[island + 1] - first_body_[island];
}

int BodyRows::slotIn(int island, int body) noexcept {
  return islandOf(body) == island ? slot_[body] : -1;
}

void BodyRows::writeHandRow(int slot, const btVector3& linear, const btVector3& angular,
                            IslandNewton::Six& along) const noexcept {
  for (int i = 0; i < 3; ++i) along[i] = roots_[slot].linear * linear[i];
  roots_[slot].angular.transpose(angular.m_floats, along.data() + 3);
}

void BodyRows::takeWithHand(int island, Bodies& bodies, JointRows& joints) noexcept {
  takeImpulses(island, bodies, joints);
  putMotions(island, bodies);
}

// Takes a contact out of the sweeps.
void BodyRows::silence(Group& group, int place) noexcept {
  for (Row* row : {&group.normal, &group.tangent1, &group.tangent2}) {
    for (EachVector* of :
         {&row->along, &row->about_a, &row->about_b, &row->response_a, &row->response_b}) {
      for (Each& each : *of) each[place] = 0.0;
    }
    row->target[place] = row->effective_mass[place] = row->impulse[place] = 0.0;
  }
  group.friction[place] = 0.0;
  group.point[place] = nullptr;
}

void BodyRows::takeImpulses(int island, Bodies& bodies, JointRows& joints) noexcept {
  const int first_body = first_body_[island], first_place = first_place_[island];
  for (int i = 0; i < first_place_[island + 1] - first_place; ++i) {
    const Place& at = places_[first_place + i];
    const IslandNewton::Contact& contact = newton_.contact(i);
    btManifoldPoint& point = *at.group->point[at.place];
    point.m_appliedImpulse = contact.impulse[0];
    point.m_appliedImpulseLateral1 = contact.impulse[1];
    point.m_appliedImpulseLateral2 = contact.impulse[2];
    silence(*at.group, at.place);
  }
  for (int i = 0; i < first_body_[island + 1] - first_body; ++i) {
    const IslandNewton::Six& change = newton_.change(i);
    const int body = members_[first_body + i];
    Motion& motion = motions_[body];
    for (int k = 0; k < 3; ++k) motion.linear[k] = roots_[i].linear * change[k];
    roots_[i].angular.apply(change.data() + 3, motion.angular.data());
    if (jointOf(bodies[body]) == nullptr) continue;
    joints.takeFrom(newton_, body);
    bodies[body].m_deltaAngularVelocity.setValue(motion.angular[0], motion.angular[1],
                                                 motion.angular[2]);
  }
}

void BodyRows::noteTouched(int island, const Bodies& bodies) noexcept {
  const auto first = members_.begin() + first_body_[island],
             last = members_.begin() + first_body_[island + 1];
  if (last - first < 2) return;
  if (std::any_of(first, last, [&](int body) { return jointOf(bodies[body]) != nullptr; })) return;
  touched_islands_.push_back(island);
}

void BodyRows::addHand(int body, const btVector3& linear, const btVector3& angular) noexcept {
  Motion& of = hand_[body];
  for (int i = 0; i < 3; ++i) {
    of.linear[i] += linear[i];
    of.angular[i] += angular[i];
  }
}

void BodyRows::putMotions(int island, Bodies& bodies) noexcept {
  for (int i = first_body_[island]; i < first_body_[island + 1]; ++i) {
    const int body = members_[i];
    const Motion& motion = motions_[body];
    bodies[body].m_deltaLinearVelocity.setValue(motion.linear[0], motion.linear[1],
                                                motion.linear[2]);
    bodies[body].m_deltaAngularVelocity.setValue(motion.angular[0], motion.angular[1],
                                                 motion.angular[2]);
  }
}

void BodyRows::solveTouched(Bodies& bodies, JointRows& joints) noexcept {
  for (const int island : touched_islands_) {
    if (!fits(island, 0)) continue;
    beginTouched(island, bodies, 0);
    for (int i = 0; i < newton_.contactCount(); ++i) {
      subtractHand(places_[first_place_[island] + i], newton_.contact(i));
    }
    if (!solveBegun()) continue;
    takeImpulses(island, bodies, joints);
    for (int i = first_body_[island]; i < first_body_[island + 1]; ++i) {
      Motion& motion = motions_[members_[i]];
      const Motion& by_hand = hand_[members_[i]];
      for (int k = 0; k < 3; ++k) {
        motion.linear[k] += by_hand.linear[k];
        motion.angular[k] += by_hand.angular[k];
      }
    }
    putMotions(island, bodies);
  }
}

void BodyRows::solveIslands(Bodies& bodies, const std::vector<bool>& by_hand,
                            JointRows& joints) noexcept {
  if (!any()) return;
  sortByIsland(bodies, by_hand);
  work_ = kMostWork;
  for (int body = 0; body < bodies.size(); ++body) {
    if (!moves(bodies[body]) || islandOf(body) != body) continue;
    if (first_place_[body + 1] == first_place_[body]) continue;
    if (swept_[body] != 0) {
      noteTouched(body, bodies);
      continue;
    }
    if (solveIsland(body, bodies, joints)) {
      takeImpulses(body, bodies, joints);
    } else {
      swept_[body] = 1;
    }
  }
  if (!touched_islands_.empty()) std::fill_n(hand_.begin(), bodies.size(), Motion{});
  const auto is_solved = [](const Group* group) {
    return std::all_of(group->point.begin(), group->point.end(),
                       [](const btManifoldPoint* point) { return point == nullptr; });
  };
  std::erase_if(all_, is_solved);
  std::erase_if(near_, is_solved);
}

}  // namespace wholehand::bullet
