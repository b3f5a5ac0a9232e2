#include "picture/skin_field.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr double kPad_m = 0.028;  // grid beyond the colliders, for occlusion
constexpr double kSameJoint_m = 0.001;

}  // namespace

SkinField::SkinField(const HandModel& hand, const std::vector<Pose>& link_poses, SkinRecipe recipe)
    : recipe_(recipe) {
  place(hand, link_poses);
  if (empty()) return;
  taper();
  bound();
  sampleGrid();
  listCandidates();
}

void SkinField::place(const HandModel& hand, const std::vector<Pose>& link_poses) {
  for (const Capsule& c : hand.capsules) {
    const Pose& pose = link_poses[static_cast<std::size_t>(c.link)];
    const HandLink& link = hand.links[static_cast<std::size_t>(c.link)];
    Placed placed;
    placed.a = pose * c.a_m;
    placed.ab = pose * c.b_m - placed.a;
    placed.length = placed.ab.norm();
    placed.inverse_length2 = placed.length > 0.0 ? 1.0 / placed.ab.squaredNorm() : 0.0;
    placed.radius = c.radius_m;
    placed.part = c.part;
    placed.tip = c.part != HandPart::kPalm && c.name.find("distal") != std::string::npos;
    // Flexion is positive and moves a digit towards its pulp: axis x direction points there.
    const Pose& palm = link_poses[static_cast<std::size_t>(hand.palm_link)];
    const Vector3d bent = (pose.rotation * link.axis).cross(placed.ab);
    const bool digit = c.part != HandPart::kPalm && bent.norm() > 0.7 * placed.length;
    placed.palmar = digit ? Vector3d(bent.normalized()) : Vector3d(-palm.rotation.col(2));
    if (placed.tip && digit) addNail(placed);
    capsules_.push_back(placed);
  }
}

/// Where two capsules of a digit share a joint, the skin takes the radius between theirs: fingers
/// narrow from joint to joint instead of in steps.
void SkinField::taper() {
  for (Placed& c : capsules_) {
    c.skin_radius_a = c.skin_radius_b = c.radius;
    if (c.part == HandPart::kPalm) continue;
    for (const Placed& other : capsules_) {
      if (other.part != c.part || &other == &c) continue;
      const double between = 0.5 * (c.radius + other.radius);
      if ((other.a + other.ab - c.a).norm() < kSameJoint_m) {
        c.skin_radius_a = between;
        c.bend = c.ab.normalized() - other.ab.normalized();
        c.joined = true;
      }
      if ((other.a - c.a - c.ab).norm() < kSameJoint_m) c.skin_radius_b = between;
    }
  }
}

void SkinField::bound() {
  const double inf = std::numeric_limits<double>::infinity();
  low_m_.setConstant(inf);
  high_m_.setConstant(-inf);
  for (const Placed& c : capsules_) {
    const Vector3d r = Vector3d::Constant(c.radius), b = c.a + c.ab;
    low_m_ = low_m_.cwiseMin(c.a - r).cwiseMin(b - r);
    high_m_ = high_m_.cwiseMax(c.a + r).cwiseMax(b + r);
  }
  center_m_ = 0.5 * (low_m_ + high_m_);
  for (const Placed& c : capsules_) {
    const Vector3d a = c.a - center_m_, b = a + c.ab;
    radius_m_ = std::max(radius_m_, std::max(a.norm(), b.norm()) + c.radius + recipe_.leave_m);
  }
}

void SkinField::addNail(const Placed& distal) {
  Nail nail;
  nail.root = distal.a;
  nail.along = distal.ab.normalized();
  nail.dorsal = -distal.palmar;
  nail.side = nail.along.cross(nail.dorsal);
  nail.radius = distal.radius;
  nail.segment = distal.length;
  nail.center = distal.a + distal.ab + nail.dorsal * distal.radius;
  nails_.push_back(nail);
}

void SkinField::sampleGrid() {
  origin_m_ = low_m_ - Vector3d::Constant(kPad_m);
  const Eigen::Array3d extent = (high_m_ - low_m_).array() + 2.0 * kPad_m;
  blocks_ = (extent / (kNode_m * kBlockNodes)).ceil().cast<int>();
  nodes_ = blocks_ * kBlockNodes + 1;
  sampled_m_.resize(static_cast<std::size_t>(nodes_.prod()));
  std::size_t at = 0;
  for (int z = 0; z < nodes_.z(); ++z) {
    for (int y = 0; y < nodes_.y(); ++y) {
      for (int x = 0; x < nodes_.x(); ++x) {
        sampled_m_[at++] = static_cast<float>(colliders(origin_m_ + kNode_m * Vector3d(x, y, z)));
      }
    }
  }
}

void SkinField::listCandidates() {
  const double width = kNode_m * kBlockNodes;
  block_.resize(static_cast<std::size_t>(blocks_.prod()));
  std::size_t at = 0;
  for (int z = 0; z < blocks_.z(); ++z) {
    for (int y = 0; y < blocks_.y(); ++y) {
      for (int x = 0; x < blocks_.x(); ++x, ++at) {
        const Vector3d middle = origin_m_ + width * (Vector3d(x, y, z) + Vector3d::Constant(0.5));
        if (std::abs(colliders(middle)) > kBlockHalfDiagonal_m + kNear_m) continue;
        block_[at].drawn = candidates(middle, recipe_.blend_m);
        block_[at].lit = candidates(middle, recipe_.palm_light_m);
      }
    }
  }
}

/// The capsules that can reach skin in a block: near enough to blend, or to swell what blends.
SkinField::List SkinField::candidates(const Vector3d& middle, double blend_m) {
  const double reach = kBlockHalfDiagonal_m + kNear_m + 2.0 * blend_m;
  List list{static_cast<std::uint32_t>(candidates_.size()), 0};
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    if (capsule(capsules_[i], middle) >= reach) continue;
    candidates_.push_back(static_cast<std::uint16_t>(i));
    ++list.count;
  }
  return list;
}

}  // namespace wholehand
