#include "loop/physics/bullet/resting_bodies.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace wholehand::bullet {
namespace {

// Speeds below which a body counts as still. A body that rolls at more than half a millimetre per
// second still moves.
constexpr double kStill_m_s = 5e-4;
constexpr double kStill_rad_s = 0.0125;
// Share of these speeds below which a body on a joint counts as still although its load is not
// held: it creeps towards its end, or a contact holds it.
constexpr double kCreeps = 1e-4;
constexpr double kFall_s = 2e-3;     // a body in free fall for this time exceeds the still speed
constexpr double kRests_s = 0.5;     // time of stillness after which a group rests
constexpr double kWatched_s = 0.05;  // interval at which groups are checked

}  // namespace

RestingBodies::RestingBodies(std::vector<BulletBody>& bodies, double gravity_m_s2, bool lets_rest)
    : bodies_(bodies),
      still_m_s_(std::min(kStill_m_s, kFall_s * gravity_m_s2)),
      still_rad_s_(kStill_rad_s / kStill_m_s * still_m_s_),
      lets_rest_(lets_rest),
      awake_(bodies.size()),
      group_(bodies.size(), -1),
      still_s_(bodies.size(), 0.0),
      parent_(bodies.size()),
      least_s_(bodies.size(), 0.0) {
  awake_bodies_.reserve(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) awake_[i] = bodies[i].moves();
  listAwake();
}

bool RestingBodies::isStill(int body) const noexcept {
  const btRigidBody& rigid = bodies_[body].rigid();
  const double share = isHeld(body) ? 1.0 : kCreeps;
  return rigid.getLinearVelocity().length2() <= share * share * still_m_s_ * still_m_s_ &&
         rigid.getAngularVelocity().length2() <= share * share * still_rad_s_ * still_rad_s_;
}

// False for a body on a joint that its load would start, however slowly.
bool RestingBodies::isHeld(int body) const noexcept {
  if (const JointChain* chain = bodies_[body].chain()) return chain->loadIsHeld();
  const BodyJoint* joint = bodies_[body].joint();
  return joint == nullptr || joint->loadIsHeld();
}

void RestingBodies::listAwake() noexcept {
  ++version_;
  awake_bodies_.clear();
  for (int i = 0; i < static_cast<int>(awake_.size()); ++i) {
    if (awake_[i]) awake_bodies_.push_back(i);
  }
}

void RestingBodies::disturb(int body) noexcept {
  still_s_[body] = 0.0;
  const int group = group_[body];
  if (group < 0) return;
  for (std::size_t i = 0; i < group_.size(); ++i) {
    if (group_[i] != group) continue;
    group_[i] = -1;
    awake_[i] = true;
    still_s_[i] = 0.0;
  }
  listAwake();
}

void RestingBodies::setMoves(int body, bool moves) noexcept {
  disturb(body);
  if (awake_[body] == moves) return;
  awake_[body] = moves;
  listAwake();
}

bool RestingBodies::watch(double step_s) noexcept {
  if (!lets_rest_) return false;
  bool any = false;
  for (const int body : awake_bodies_) {
    still_s_[body] = isStill(body) ? still_s_[body] + step_s : 0.0;
    any = any || still_s_[body] >= kRests_s;
  }
  unwatched_s_ += step_s;
  if (!any || unwatched_s_ < kWatched_s) return false;
  unwatched_s_ = 0.0;
  return true;
}

void RestingBodies::restAtOnce(const std::vector<Near>& near,
                               const std::vector<bool>& fell) noexcept {
  for (const int body : awake_bodies_) {
    still_s_[body] = isStill(body) && !fell[body] && isHeld(body) ? kRests_s : 0.0;
  }
  layDown(near);
}

int RestingBodies::rootOf(int body) noexcept {
  while (parent_[body] != body) body = parent_[body] = parent_[parent_[body]];
  return body;
}

// Disjoint sets of bodies near one another, and of the links of each tree of joints; fixed bodies
// do not join sets.
void RestingBodies::group(const std::vector<Near>& near) noexcept {
  std::iota(parent_.begin(), parent_.end(), 0);
  const auto join = [this](int a, int b) {
    const int first = rootOf(a), second = rootOf(b);
    parent_[std::max(first, second)] = std::min(first, second);
  };
  for (const int body : awake_bodies_) join(body, bodies_[body].restsWith());
  for (const auto& [a, b] : near) {
    if (awake_[a] && awake_[b]) join(a, b);
  }
  std::fill(least_s_.begin(), least_s_.end(), std::numeric_limits<double>::infinity());
  for (const int body : awake_bodies_) {
    double& least_s = least_s_[rootOf(body)];
    least_s = std::min(least_s, still_s_[body]);
  }
}

void RestingBodies::layDown(const std::vector<Near>& near) noexcept {
  group(near);
  for (const int body : awake_bodies_) {
    const int first = rootOf(body);
    if (least_s_[first] < kRests_s) continue;
    group_[body] = first;
    awake_[body] = false;
    bodies_[body].stand();
  }
  listAwake();
}

}  // namespace wholehand::bullet
