#include "physics/closing_chain.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

bool moves(const HandModel& hand, int link, int axis) {
  const int joint = hand.links[link].joint;
  return joint >= 0 && hand.synergy(joint, axis) != 0.0;
}

/// The links from the one that the axis moves first to the given one; empty where it moves none.
std::vector<int> movedLinks(const HandModel& hand, int link, int axis) {
  std::vector<int> path;
  std::size_t moved = 0;
  for (int i = link; i >= 0; i = hand.links[i].parent) {
    path.push_back(i);
    if (moves(hand, i, axis)) moved = path.size();
  }
  path.resize(moved);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace

ClosingChain::ClosingChain(const HandModel& hand, int axis, int capsule) : capsule_(capsule) {
  const Capsule& c = hand.capsules[capsule];
  const std::vector<int> path = movedLinks(hand, c.link, axis);
  root_link_ = hand.links[path.front()].parent;
  radius_m_ = c.radius_m;
  Pose since;
  for (const int i : path) {
    const HandLink& link = hand.links[i];
    since = since * link.parent_to_link;
    if (link.joint < 0) continue;
    const bool turned = since.rotation != Eigen::Matrix3d::Identity();
    joints_.push_back({since, turned, link.axis, link.type == JointType::kRevolute, link.joint,
                       hand.synergy(link.joint, axis)});
    since = Pose{};
  }
  a_m_ = since * c.a_m;
  b_m_ = since * c.b_m;
  boundMotion(std::max(std::abs(hand.axis_lower[axis]), std::abs(hand.axis_upper[axis])));
}

/// Stretched out, a point is as far from a joint as it can ever be; a joint that slides lets those
/// before it see it farther off by its travel. With r_k the ratio, R_k the farthest distance and
/// w_k = r_k R_k (r_k where it slides) of joint k, and Ω_k the turn of all before it: p' = Σ r_k
/// ω_k × (p − o_k), so that |p'| ≤ Σ w_k and, by one more derivative, |p''| ≤ Σ r_k (2 Ω_k R_k +
/// Σ_{j≥k} w_j).
void ClosingChain::boundMotion(double travel) noexcept {
  double reach_m = std::max(a_m_.norm(), b_m_.norm());
  for (std::size_t k = joints_.size(); k-- > 0;) {
    const Joint& joint = joints_[k];
    const double ratio = std::abs(joint.ratio);
    double turn_before = 0.0;
    for (std::size_t j = 0; j < k; ++j) {
      if (joints_[j].revolute) turn_before += std::abs(joints_[j].ratio);
    }
    fastest_ += ratio * (joint.revolute ? reach_m : 1.0);
    sharpest_ += joint.revolute ? ratio * (2.0 * turn_before * reach_m + fastest_)
                                : 2.0 * ratio * turn_before;
    if (!joint.revolute) reach_m += ratio * travel;
    reach_m += joint.from_previous.translation_m.norm();
  }
}

void ClosingChain::place(const Pose& root, const JointPosition& theta, double q_present,
                         double q_axis, Placed& placed) const noexcept {
  Pose at = root;
  placed.joints = static_cast<int>(joints_.size());
  for (std::size_t k = 0; k < joints_.size(); ++k) {
    const Joint& joint = joints_[k];
    const double position = theta[joint.joint] + joint.ratio * (q_axis - q_present);
    at.translation_m = at * joint.from_previous.translation_m;
    if (joint.turned) at.rotation = at.rotation * joint.from_previous.rotation;
    placed.origin_m[k] = at.translation_m;
    placed.screw[k] = at.rotation * joint.axis;
    if (joint.revolute) {
      at.rotation = at.rotation * Eigen::AngleAxisd(position, joint.axis).toRotationMatrix();
    } else {
      at.translation_m += position * placed.screw[k];
    }
  }
  placed.a_m = at * a_m_;
  placed.b_m = at * b_m_;
}

Eigen::Vector3d ClosingChain::Placed::rate(const ClosingChain& chain,
                                           const Eigen::Vector3d& at_m) const {
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
  for (int k = 0; k < joints; ++k) {
    const Joint& joint = chain.joints_[k];
    rate += joint.ratio *
            (joint.revolute ? Eigen::Vector3d(screw[k].cross(at_m - origin_m[k])) : screw[k]);
  }
  return rate;
}

std::vector<std::vector<ClosingChain>> ClosingChain::ofAxes(const HandModel& hand) {
  std::vector<std::vector<ClosingChain>> chains(hand.axis_count);
  for (int axis = 0; axis < hand.axis_count; ++axis) {
    const bool has_travel = axis < hand.axis_lower.size();
    if (!has_travel || !movedLinks(hand, hand.palm_link, axis).empty()) continue;
    for (std::size_t c = 0; c < hand.capsules.size(); ++c) {
      if (movedLinks(hand, hand.capsules[c].link, axis).empty()) continue;
      chains[axis].emplace_back(hand, axis, static_cast<int>(c));
    }
  }
  return chains;
}

}  // namespace wholehand
