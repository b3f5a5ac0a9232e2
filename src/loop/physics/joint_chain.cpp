#include "loop/physics/joint_chain.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace wholehand {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

// A coordinate whose viscous friction takes a larger share of its rate in a step does not swing.
constexpr double kSwingsFreely = 0.1;
// Largest change of the rates by which an untouched step is scaled to its energy. A step that needs
// more is too long for the tree.
constexpr double kMostScale = 1e-3;
constexpr double kEnergyRounding = 1e-14;  // smaller relative changes of energies are rounding
constexpr double kUnbounded = std::numeric_limits<double>::infinity();

}  // namespace

JointChain::JointChain(const std::vector<SceneBody>& bodies, const std::vector<int>& members)
    : least_(Vector3d::Constant(-kUnbounded)),
      most_(Vector3d::Constant(kUnbounded)),
      viscous_(Vector3d::Zero()),
      dry_friction_(Vector3d::Zero()),
      gravity_m_s2_(Vector3d::Zero()),
      next_q_(Vector3d::Zero()),
      mobility_(Matrix3d::Zero()),
      resistance_(Matrix3d::Identity()),
      most_friction_(Vector3d::Zero()),
      least_rate_(least_),
      most_rate_(most_) {
  // The joints that lead number the coordinates; then every joint finds the one that it follows.
  std::vector<int> coordinate_of(bodies.size(), -1);
  for (const int body : members) {
    if (bodies[body].joint->follows < 0) coordinate_of[body] = coordinates_++;
  }
  for (const int body : members) {
    addLink(bodies, members, body);
    const SceneJoint& joint = *bodies[body].joint;
    Link& link = links_.back();
    link.coordinate = coordinate_of[joint.follows < 0 ? body : joint.follows];
    link.ratio = joint.follows < 0 ? 1.0 : joint.ratio;
    const int k = link.coordinate;
    viscous_[k] += link.ratio * link.ratio * joint.viscous_friction;
    dry_friction_[k] += std::abs(link.ratio) * joint.dry_friction;
    if (joint.follows >= 0) continue;
    least_[k] = joint.least, most_[k] = joint.most;
  }
  now_.places.resize(links_.size());
  next_.places.resize(links_.size());
  put(Vector3d::Zero(), Vector3d::Zero());
}

void JointChain::addLink(const std::vector<SceneBody>& bodies, const std::vector<int>& members,
                         int body) {
  const SceneBody& of = bodies[body];
  Link& link = links_.emplace_back();
  link.joint = *of.joint;
  link.start = of.pose;
  link.com_m = of.com_m;
  link.mass_kg = of.mass_kg;
  link.inertia_kg_m2 = of.inertia_kg_m2;
  const auto parent = std::find(members.begin(), members.end(), of.joint->parent);
  if (parent == members.end()) return;
  link.parent = static_cast<int>(parent - members.begin());
  link.start = bodies[*parent].pose.inverse() * of.pose;
}

void JointChain::put(const Vector3d& q, const Vector3d& rate) noexcept {
  q_ = q;
  rate_ = rate;
  place(q_, now_);
}

void JointChain::place(const Vector3d& q, Figure& at) const noexcept {
  at.inertia.setZero();
  at.first_kg_m.setZero();
  for (int k = coordinates_; k < 3; ++k) at.inertia(k, k) = 1.0;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    Place& to = at.places[i];
    to.pose = poseOn(link.joint, link.start, link.ratio * q[link.coordinate]);
    if (link.parent >= 0) to.pose = at.places[link.parent].pose * to.pose;
    to.com_m = to.pose * link.com_m;
    to.axis = to.pose.rotation * link.joint.axis;
    to.point_m = to.pose * link.joint.point_m;
    if (link.parent >= 0) {
      const Place& from = at.places[link.parent];
      const Vector3d arm_m = to.com_m - from.com_m;
      to.angular = from.angular;
      for (int k = 0; k < 3; ++k) {
        to.linear.col(k) = from.linear.col(k) + from.angular.col(k).cross(arm_m);
      }
    } else {
      to.angular.setZero();
      to.linear.setZero();
    }
    const Vector3d own = link.ratio * to.axis;
    if (link.joint.isHinge()) {
      to.angular.col(link.coordinate) += own;
      to.linear.col(link.coordinate) += own.cross(to.com_m - to.point_m);
    } else {
      to.linear.col(link.coordinate) += own;
    }
    const Matrix3d turns = to.pose.rotation.transpose() * to.angular;
    at.inertia += link.mass_kg * to.linear.transpose() * to.linear;
    at.inertia += turns.transpose() * link.inertia_kg_m2 * turns;
    at.first_kg_m += link.mass_kg * to.com_m;
  }
}

JointChain::Forces JointChain::forces(const Vector3d& rate, const Vector3d& gravity_m_s2,
                                      Figure& at) const noexcept {
  Forces sum{Vector3d::Zero(), Vector3d::Zero()};
  Place world;
  world.com_m = world.spin = world.turning = world.pulled = Vector3d::Zero();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    Place& to = at.places[i];
    const Place& from = link.parent >= 0 ? at.places[link.parent] : world;
    const Vector3d own = link.ratio * rate[link.coordinate] * to.axis;
    // Acceleration of the point of the parent's body that lies at `at_m`.
    const auto carried = [&](const Vector3d& at_m) -> Vector3d {
      const Vector3d arm_m = at_m - from.com_m;
      return from.pulled + from.turning.cross(arm_m) + from.spin.cross(from.spin.cross(arm_m));
    };
    to.spin = to.angular * rate;
    if (link.joint.isHinge()) {
      const Vector3d arm_m = to.com_m - to.point_m;
      to.turning = from.turning + from.spin.cross(own);
      to.pulled =
          carried(to.point_m) + to.turning.cross(arm_m) + to.spin.cross(to.spin.cross(arm_m));
    } else {
      to.turning = from.turning;
      to.pulled = carried(to.com_m) + 2.0 * from.spin.cross(own);
    }
    const Matrix3d inertia = to.pose.rotation * link.inertia_kg_m2 * to.pose.rotation.transpose();
    sum.weight += link.mass_kg * (to.linear.transpose() * gravity_m_s2);
    sum.inertial -=
        link.mass_kg * (to.linear.transpose() * to.pulled) +
        to.angular.transpose() * (inertia * to.turning + to.spin.cross(inertia * to.spin));
  }
  return sum;
}

double JointChain::energyOf(const Figure& at, const Vector3d& rate,
                            const Vector3d& gravity_m_s2) noexcept {
  return 0.5 * rate.dot(at.inertia * rate) - gravity_m_s2.dot(at.first_kg_m);
}

Vector3d JointChain::acceleration(const Vector3d& rate, Figure& at) noexcept {
  const Forces f = forces(rate, gravity_m_s2_, at);
  return at.inertia.inverse() * (f.weight + f.inertial - viscous_.cwiseProduct(rate));
}

// False where the tree does not swing freely: a coordinate has dry friction or much viscous
// friction, meets an end of its range, or is too fast for the step.
bool JointChain::swing(const Forces& now, double step_s) noexcept {
  const Matrix3d inverse = now_.inertia.inverse();
  for (int k = 0; k < coordinates_; ++k) {
    if (dry_friction_[k] > 0.0 || step_s * viscous_[k] * inverse(k, k) > kSwingsFreely)
      return false;
  }
  const double half_s = 0.5 * step_s;
  const Vector3d a1 = inverse * (now.weight + now.inertial - viscous_.cwiseProduct(rate_));
  const Vector3d v2 = rate_ + half_s * a1;
  place(q_ + half_s * rate_, next_);
  const Vector3d a2 = acceleration(v2, next_);
  const Vector3d v3 = rate_ + half_s * a2;
  place(q_ + half_s * v2, next_);
  const Vector3d a3 = acceleration(v3, next_);
  const Vector3d v4 = rate_ + step_s * a3;
  place(q_ + step_s * v3, next_);
  const Vector3d a4 = acceleration(v4, next_);
  next_q_ = q_ + step_s / 6.0 * (rate_ + 2.0 * (v2 + v3) + v4);
  for (int k = 0; k < coordinates_; ++k) {
    if (!(next_q_[k] >= least_[k] && next_q_[k] <= most_[k])) return false;
  }
  Vector3d rate = rate_ + step_s / 6.0 * (a1 + 2.0 * (a2 + a3) + a4);
  place(next_q_, next_);
  const double kinetic_j = 0.5 * rate.dot(next_.inertia * rate);
  const double fallen_j = gravity_m_s2_.dot(next_.first_kg_m), allowed_j = begun_j_ + fallen_j;
  const double rounding_j = kEnergyRounding * (std::abs(begun_j_) + std::abs(fallen_j));
  const bool keeps = viscous_.isZero(0.0);
  if (kinetic_j > allowed_j + rounding_j || (keeps && kinetic_j < allowed_j - rounding_j)) {
    const double scale = kinetic_j > 0.0 ? std::sqrt(std::max(0.0, allowed_j / kinetic_j)) : 0.0;
    if (!(std::abs(scale - 1.0) <= kMostScale)) return false;
    rate *= scale;
  }
  rate_ = rate;
  return true;
}

void JointChain::predict(const Vector3d& gravity_m_s2, double step_s, bool touched) noexcept {
  gravity_m_s2_ = gravity_m_s2;
  begun_j_ = energyOf(now_, rate_, gravity_m_s2);
  const Forces now = forces(rate_, gravity_m_s2, now_);
  load_is_held_ = true;
  for (int k = 0; k < coordinates_; ++k) {
    const double load = now.weight[k];
    const bool held = std::abs(load) <= dry_friction_[k] || (q_[k] <= least_[k] && load < 0.0) ||
                      (q_[k] >= most_[k] && load > 0.0);
    load_is_held_ = load_is_held_ && held;
  }
  untouched_ = !touched && swing(now, step_s);
  resistance_ = now_.inertia;
  for (int k = 0; k < coordinates_; ++k) resistance_(k, k) += step_s * viscous_[k];
  mobility_ = resistance_.inverse();
  for (int k = coordinates_; k < 3; ++k) mobility_(k, k) = 0.0;
  if (untouched_) {
    most_friction_.setZero();
    least_rate_.setConstant(-kUnbounded);
    most_rate_.setConstant(kUnbounded);
    return;
  }
  rate_ = mobility_ * (now_.inertia * rate_ + step_s * (now.weight + now.inertial));
  most_friction_ = step_s * dry_friction_;
  least_rate_ = (least_ - q_) / step_s;
  most_rate_ = (most_ - q_) / step_s;
}

void JointChain::move(const Vector3d& rate, double step_s) noexcept {
  if (untouched_) {
    q_ = next_q_;
    std::swap(now_, next_);
    return;
  }
  const double work_j = rate.dot(resistance_ * (rate - rate_));
  rate_ = rate;
  q_ = (q_ + step_s * rate_).cwiseMax(least_).cwiseMin(most_);
  place(q_, now_);
  const double kinetic_j = 0.5 * rate_.dot(now_.inertia * rate_);
  const double fallen_j = gravity_m_s2_.dot(now_.first_kg_m);
  const double allowed_j = begun_j_ + work_j + fallen_j;
  const double rounding_j =
      kEnergyRounding * (std::abs(begun_j_) + std::abs(work_j) + std::abs(fallen_j));
  if (kinetic_j > allowed_j + rounding_j) {
    rate_ *= std::sqrt(std::max(0.0, allowed_j / kinetic_j));
  }
}

}  // namespace wholehand
