#include "loop/physics/bullet/bullet_hand.hpp"

#include "loop/core/compiler.hpp"
#include "loop/physics/bullet/bullet_types.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
BulletHand::BulletHand(const HandModel& hand, double friction)
    : capsules_(hand.capsules),
      placed_(hand.capsules.size()),
      has_frame_(hand.capsules.size(), false) {
  tags_.reserve(hand.capsules.size());
  for (const Capsule& capsule : hand.capsules) {
    const Eigen::Vector3d along = capsule.b_m - capsule.a_m;
    const double length = along.norm();
    Pose at;
    at.translation_m = 0.5 * (capsule.a_m + capsule.b_m);
    if (length > 0.0) {
      at.rotation =
          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), along).toRotationMatrix();
    }
    capsule_in_link_.push_back(at);
    placed_[tags_.size()].radius_m = capsule.radius_m;
    palm_.push_back(capsule.part == HandPart::kPalm);
    shapes_.push_back(std::make_unique<btCapsuleShapeZ>(capsule.radius_m, length));
    Shape& form = forms_.emplace_back();
    form.type = ShapeType::kCapsule;
    form.radius_m = capsule.radius_m;
    form.length_m = length;
    tags_.push_back({static_cast<int>(tags_.size()), capsule.link, -1, nullptr, nullptr});
    auto object = std::make_unique<btCollisionObject>();
    object->setCollisionShape(shapes_.back().get());
    object->setUserPointer(&tags_.back());
    object->setFriction(std::sqrt(friction));  // square root: see BulletBody::addCollider()
    objects_.push_back(std::move(object));
  }
}

WHOLEHAND_VECTOR_CLONES void BulletHand::placeAll() noexcept {
  box_ = WorldBox{};
  for (std::size_t i = 0; i < capsules_.size(); ++i) {
    const Capsule& capsule = capsules_[i];
    const Pose& link = kinematics_->linkPose(capsule.link);
    PlacedCapsule& placed = placed_[i];
    for (int k = 0; k < 3; ++k) {
      const auto along = [&](const Eigen::Vector3d& p) {
        return link.rotation(k, 0) * p.x() + link.rotation(k, 1) * p.y() +
               link.rotation(k, 2) * p.z() + link.translation_m[k];
      };
      const double a_m = along(capsule.a_m), b_m = along(capsule.b_m);
      placed.a_m[k] = a_m;
      placed.b_m[k] = b_m;
      placed.box.low_m[k] = std::min(a_m, b_m) - capsule.radius_m;
      placed.box.high_m[k] = std::max(a_m, b_m) + capsule.radius_m;
      box_.low_m[k] = std::min(box_.low_m[k], placed.box.low_m[k]);
      box_.high_m[k] = std::max(box_.high_m[k], placed.box.high_m[k]);
    }
  }
}

void BulletHand::placeCapsules(const ArticulatedBody& kinematics) noexcept {
  kinematics_ = &kinematics;
  std::fill(has_frame_.begin(), has_frame_.end(), false);
  placeAll();
}

btCollisionObject& BulletHand::object(int capsule) noexcept {
  btCollisionObject& object = *objects_[capsule];
  if (!has_frame_[capsule]) {
    has_frame_[capsule] = true;
    object.setWorldTransform(
        toBt(kinematics_->linkPose(tags_[capsule].link) * capsule_in_link_[capsule]));
  }
  return object;
}

}  // namespace wholehand::bullet
