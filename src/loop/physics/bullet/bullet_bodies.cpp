#include "loop/physics/bullet/bullet_bodies.hpp"

#include "loop/physics/bullet/bullet_shapes.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/physics_world.hpp"

#include <BulletCollision/CollisionShapes/btEmptyShape.h>
#include <Eigen/Geometry>

#include <cmath>

namespace wholehand::bullet {
namespace {

// A body that is placed farther away than this within one period has lost its contacts. Bullet
// removes points that separate; a point against whose normal the body was moved would remain as an
// overlap.
constexpr double kFarthestSlide_m = 2e-3;
constexpr double kFarthestTurn_rad = 0.05;
// Time ahead for the boxes of a body that was placed.
constexpr double kLongestStep_s = 1e-2;

}  // namespace

BulletBody::BulletBody(const SceneBody& body, int index, double reach_m)
    : no_shape_(new btEmptyShape), index_(index), lead_(index), reach_m_(reach_m) {
  btVector3 moments(0, 0, 0);
  from_body_ = principalFrame(body, moments);
  start_ = toBt(body.pose * from_body_);
  const double mass = body.fixed ? 0.0 : body.mass_kg;
  if (body.fixed) moments.setZero();
  rigid_ = std::make_unique<btRigidBody>(
      btRigidBody::btRigidBodyConstructionInfo(mass, nullptr, no_shape_.get(), moments));
  rigid_->setDamping(body.linear_damping_per_s, 0.0);
  if (body.joint && !body.fixed) joint_.emplace(body);
  // Switches Bullet's gyroscopic torque off, because moveFree() conserves the angular momentum.
  rigid_->setFlags(0);
  for (const Shape& shape : body.shapes) {
    if (body.soft_m > 0.0) {
      addCollider(body, shape, Meets::kAllButDigits);
      addCollider(body, coreOf(body, shape), Meets::kDigits);
    } else {
      addCollider(body, shape, Meets::kAll);
    }
  }
  putAtStart();
}

void BulletBody::addCollider(const SceneBody& body, const Shape& shape, Meets meets) {
  auto collider = std::make_unique<Collider>();
  collider->meets = meets;
  collider->form = shape;
  collider->form.in_body = Pose{};
  const bool closed_form = !shape.isMesh();
  collider->tag = {-1, -1, index_, rigid_.get(), closed_form ? &collider->form : nullptr};
  collider->shape = makeShape(shape);
  collider->in_rigid = toBt(from_body_.inverse() * shape.in_body);
  collider->object = std::make_unique<btCollisionObject>();
  btCollisionObject& object = *collider->object;
  object.setCollisionShape(collider->shape.get());
  object.setUserPointer(&collider->tag);
  // Bullet multiplies the two coefficients of a pair; with square roots, a pair of equal
  // coefficients gets that coefficient.
  object.setFriction(std::sqrt(body.friction));
  colliders_.push_back(std::move(collider));
}

BulletBody::BulletBody(int index, int pieces, double reach_m)
    : start_(btTransform::getIdentity()),
      no_shape_(new btEmptyShape),
      index_(index),
      lead_(index),
      reach_m_(reach_m) {
  rigid_ = std::make_unique<btRigidBody>(
      btRigidBody::btRigidBodyConstructionInfo(0.0, nullptr, no_shape_.get(), btVector3(0, 0, 0)));
  rigid_->setFlags(0);
  for (int i = 0; i < pieces; ++i) addEmptyCollider();
  putAtStart();
}

void BulletBody::addEmptyCollider() {
  auto collider = std::make_unique<Collider>();
  collider->used = false;
  collider->tag = {-1, -1, index_, rigid_.get(), nullptr};
  collider->in_rigid.setIdentity();
  collider->object = std::make_unique<btCollisionObject>();
  collider->object->setCollisionShape(no_shape_.get());
  collider->object->setUserPointer(&collider->tag);
  colliders_.push_back(std::move(collider));
}

void BulletBody::setMass(double mass_kg, const btVector3& moments, double friction,
                         const btVector3& gravity) noexcept {
  rigid_->setMassProps(mass_kg, mass_kg * moments);
  rigid_->setGravity(gravity);
  rigid_->updateInertiaTensor();
  for (const auto& collider : colliders_) collider->object->setFriction(std::sqrt(friction));
}

void BulletBody::setPieces(const SlotPiece* pieces, int count,
                           const Eigen::Quaterniond& from_body) noexcept {
  from_body_ = {from_body.toRotationMatrix(), Eigen::Vector3d::Zero()};
  for (int i = 0; i < static_cast<int>(colliders_.size()); ++i) {
    Collider& collider = *colliders_[i];
    collider.used = i < count;
    collider.object->setCollisionShape(no_shape_.get());
    collider.tag.shape = nullptr;
    collider.form.type = ShapeType::kConvexMesh;
    if (!collider.used) {
      collider.box = WorldBox{};
      continue;
    }
    const SlotPiece& piece = pieces[i];
    static_cast<ShapeForm&>(collider.form) = piece;
    if (!piece.isMesh()) collider.tag.shape = &collider.form;
    collider.in_rigid = piece.in_rigid;
    collider.object->setCollisionShape(collider.slot_shape.make(piece));
  }
}

void BulletBody::putAt(const BodyPose& pose, const Vec3& velocity_m_s) noexcept {
  const Eigen::Quaterniond turned =
      pose.orientation_xyzw.eigen().normalized() * Eigen::Quaterniond(from_body_.rotation);
  put(btTransform(btQuaternion(turned.x(), turned.y(), turned.z(), turned.w()),
                  toBt(pose.position_m.eigen())),
      toBt(velocity_m_s.eigen()));
}

void BulletBody::placeColliders(double ahead_s) noexcept {
  const Eigen::Vector3d way_m = ahead_s * toEigen(rigid_->getLinearVelocity());
  for (const auto& collider : colliders_) {
    if (!collider->used) continue;
    const btTransform at = rigid_->getWorldTransform() * collider->in_rigid;
    collider->object->setWorldTransform(at);
    btVector3 low, high;
    collider->object->getCollisionShape()->getAabb(at, low, high);
    collider->box.low_m = toEigen(low).array() - reach_m_ + way_m.array().min(0.0);
    collider->box.high_m = toEigen(high).array() + reach_m_ + way_m.array().max(0.0);
  }
}

bool BulletBody::place(const BodyPlacement& placement) noexcept {
  if (!isPose(placement) || chain_ != nullptr) return false;
  btTransform at = placedAt(placement, from_body_);
  if (joint_) {
    joint_->put(joint_->nearest(toPose(at) * from_body_.inverse()), 0.0);
    at = toBt(joint_->pose() * from_body_);
  }
  const btTransform& before = rigid_->getWorldTransform();
  const bool elsewhere =
      (at.getOrigin() - before.getOrigin()).length() > kFarthestSlide_m ||
      std::abs(at.getRotation().dot(before.getRotation())) < std::cos(kFarthestTurn_rad / 2.0);
  put(at, toBt(placement.velocity_m_s.eigen()));
  if (joint_) {
    const Eigen::Vector3d along = joint_->twist().linear;
    const double share = along.squaredNorm();
    if (share > 0.0) {
      joint_->put(joint_->position(), along.dot(placement.velocity_m_s.eigen()) / share);
    }
    moveWithJoint();
  }
  placed_ = true;
  return elsewhere;
}

void BulletBody::beginStep() noexcept {
  if (rigid_->isStaticObject() && !placed_) rigid_->setLinearVelocity(btVector3(0, 0, 0));
  placed_ = false;
}

void BulletBody::moveWithJoint() noexcept {
  const BodyJoint::Twist twist = joint_->twist();
  rigid_->setLinearVelocity(joint_->rate() * toBt(twist.linear));
  rigid_->setAngularVelocity(joint_->rate() * toBt(twist.angular));
}

// The solver stores the change of q̇ as the x of the angular velocity.
void BulletBody::finishJoint(double step_s) noexcept {
  const double before = joint_->rate() * joint_->twist().angular.x();
  joint_->move(joint_->rate() + (rigid_->getAngularVelocity().x() - before), step_s);
  rigid_->proceedToTransform(toBt(joint_->pose() * from_body_));
  moveWithJoint();
}

void BulletBody::joinChain(JointChain& chain, int link, int lead) {
  joint_.reset();
  chain_ = &chain;
  link_ = link;
  lead_ = lead;
}

void BulletBody::moveWithChain() noexcept {
  rigid_->setLinearVelocity(toBt(chain_->velocity(link_)));
  rigid_->setAngularVelocity(toBt(chain_->spin(link_)));
}

void BulletBody::placeOnChain() noexcept {
  rigid_->proceedToTransform(toBt(chain_->pose(link_) * from_body_));
}

void BulletBody::stand() noexcept {
  const btVector3 none(0, 0, 0);
  if (chain_ != nullptr) chain_->put(chain_->position(), Eigen::Vector3d::Zero());
  if (joint_) joint_->put(joint_->position(), 0.0);
  rigid_->setLinearVelocity(none);
  rigid_->setAngularVelocity(none);
  rigid_->setInterpolationLinearVelocity(none);
  rigid_->setInterpolationAngularVelocity(none);
}

void BulletBody::putAtStart() noexcept {
  if (joint_) joint_->put(0.0, 0.0);
  if (chain_ != nullptr) chain_->put(Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero());
  put(start_, btVector3(0, 0, 0));
}

void BulletBody::put(const btTransform& at, const btVector3& velocity) noexcept {
  const btVector3 none(0, 0, 0);
  rigid_->setWorldTransform(at);
  rigid_->setInterpolationWorldTransform(at);
  rigid_->setLinearVelocity(velocity);
  rigid_->setAngularVelocity(none);
  rigid_->setInterpolationLinearVelocity(velocity);
  rigid_->setInterpolationAngularVelocity(none);
  rigid_->clearForces();
  rigid_->updateInertiaTensor();
  placeColliders(kLongestStep_s);
}

BodyState BulletBody::state() const noexcept {
  const btTransform& at = rigid_->getWorldTransform();
  const btQuaternion q = at.getRotation();
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()) *
      Eigen::Quaterniond(Eigen::Matrix3d(from_body_.rotation.transpose()));
  return {toVec3(at.getOrigin()), QuatXyzw::from(turned), toVec3(rigid_->getLinearVelocity()),
          toVec3(rigid_->getAngularVelocity())};
}

}  // namespace wholehand::bullet
