#include "physics/bullet/bullet_hand.hpp"

#include "physics/bullet/bullet_types.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <cmath>

namespace wholehand::bullet {
namespace {

// Bullet wants a link's frame along the principal axes of its inertia.
struct PrincipalLink {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns, in our link frame
  Eigen::Vector3d moments = Eigen::Vector3d::Zero();
};

PrincipalLink principal(const HandLink& link) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(link.inertia_kg_m2);
  PrincipalLink out{solver.eigenvectors(), solver.eigenvalues()};
  if (out.axes.determinant() < 0.0) out.axes.col(2) = -out.axes.col(2);
  return out;
}

}  // namespace

std::unique_ptr<btMultiBody> makeMultiBody(const HandModel& hand) {
  const int count = static_cast<int>(hand.links.size());
  auto body = std::make_unique<btMultiBody>(count, 0.0, btVector3(0, 0, 0), true, false);
  std::vector<PrincipalLink> frames(hand.links.size());
  for (int i = 0; i < count; ++i) {
    const HandLink& link = hand.links[i];
    frames[i] = principal(link);
    const bool has_parent = link.parent >= 0;
    const Eigen::Matrix3d parent_axes =
        has_parent ? frames[link.parent].axes : Eigen::Matrix3d::Identity();
    const Eigen::Vector3d parent_com =
        has_parent ? hand.links[link.parent].com_m : Eigen::Vector3d::Zero();
    const Eigen::Matrix3d in_parent =
        parent_axes.transpose() * link.parent_to_link.rotation * frames[i].axes;
    const btQuaternion parent_to_this = toBtQuaternion(in_parent.transpose());
    const btVector3 pivot = toBt(Eigen::Vector3d(parent_axes.transpose() *
                                                 (link.parent_to_link.translation_m - parent_com)));
    const btVector3 com = toBt(Eigen::Vector3d(frames[i].axes.transpose() * link.com_m));
    const btVector3 axis = toBt(Eigen::Vector3d(frames[i].axes.transpose() * link.axis));
    const btVector3 inertia = toBt(frames[i].moments);
    switch (link.type) {
      case JointType::kPrismatic:
        body->setupPrismatic(i, link.mass_kg, inertia, link.parent, parent_to_this, axis, pivot,
                             com, true);
        break;
      case JointType::kRevolute:
        body->setupRevolute(i, link.mass_kg, inertia, link.parent, parent_to_this, axis, pivot, com,
                            true);
        break;
      case JointType::kFixed:
        body->setupFixed(i, link.mass_kg, inertia, link.parent, parent_to_this, pivot, com, true);
        break;
    }
  }
  body->finalizeMultiDof();
  body->setLinearDamping(0.0);
  body->setAngularDamping(0.0);
  body->setMaxCoordinateVelocity(1e4);  // stock 100 rad/s would clip a fast finger
  body->setCanSleep(false);
  body->setHasSelfCollision(false);
  body->setUseGyroTerm(true);
  return body;
}

BulletHand::BulletHand(const HandModel& hand, double friction)
    : hand_(hand), body_(makeMultiBody(hand)), link_of_joint_(hand.joint_count) {
  for (int i = 0; i < static_cast<int>(hand.links.size()); ++i) {
    if (hand.links[i].joint >= 0) link_of_joint_[hand.links[i].joint] = i;
  }
  addCapsules(friction);
}

void BulletHand::addCapsules(double friction) {
  tags_.reserve(hand_.capsules.size());
  for (const Capsule& capsule : hand_.capsules) {
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

void BulletHand::readJoints(JointPosition& theta, JointVelocity& theta_dot) const noexcept {
  theta = JointPosition(hand_.joint_count);
  theta_dot = JointVelocity(hand_.joint_count);
  for (int j = 0; j < hand_.joint_count; ++j) {
    theta[j] = body_->getJointPos(link_of_joint_[j]);
    theta_dot[j] = body_->getJointVel(link_of_joint_[j]);
  }
}

void BulletHand::writeJoints(const JointPosition& theta, const double* theta_dot) noexcept {
  for (int j = 0; j < hand_.joint_count; ++j) {
    body_->setJointPos(link_of_joint_[j], theta[j]);
    body_->setJointVel(link_of_joint_[j], theta_dot[j]);
  }
}

void BulletHand::addTorque(const JointEffort& torque) noexcept {
  for (int j = 0; j < hand_.joint_count; ++j) body_->addJointTorque(link_of_joint_[j], torque[j]);
}

}  // namespace wholehand::bullet
