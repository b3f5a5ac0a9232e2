#include "physics/bullet/bullet_hand.hpp"

#include "physics/bullet/bullet_types.hpp"

#include <Eigen/Geometry>

#include <cmath>

namespace wholehand::bullet {
BulletHand::BulletHand(const HandModel& hand, double friction) {
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
    shapes_.push_back(std::make_unique<btCapsuleShapeZ>(capsule.radius_m, length));
    tags_.push_back({static_cast<int>(tags_.size()), capsule.link, -1, nullptr, nullptr});
    auto object = std::make_unique<btCollisionObject>();
    object->setCollisionShape(shapes_.back().get());
    object->setUserPointer(&tags_.back());
    object->setFriction(std::sqrt(friction));  // see makeBody()
    object->setActivationState(DISABLE_DEACTIVATION);
    object->setCollisionFlags(btCollisionObject::CF_HAS_FRICTION_ANCHOR);
    objects_.push_back(std::move(object));
  }
}

void BulletHand::placeCapsules(const ArticulatedBody& kinematics) noexcept {
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const btTransform at = toBt(kinematics.linkPose(tags_[i].link) * capsule_in_link_[i]);
    objects_[i]->setWorldTransform(at);
    objects_[i]->setInterpolationWorldTransform(at);
  }
}

}  // namespace wholehand::bullet
