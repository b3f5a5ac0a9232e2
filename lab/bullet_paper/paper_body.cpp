#include "lab/bullet_paper/paper_body.hpp"

#include "lab/bullet_paper/collision_groups.hpp"
#include "loop/physics/bullet/bullet_shapes.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/physics_world.hpp"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <Eigen/Geometry>

#include <cmath>
#include <utility>

namespace wholehand::bullet_paper {
namespace {

using bullet::toBt;

// A body placed farther than this within one period loses its contacts, as in the engine bullet.
constexpr double kFarthestSlide_m = 2e-3;
constexpr double kFarthestTurn_rad = 0.05;

const btVector3 kNone(0, 0, 0);

bool isFarFrom(const btTransform& there, const btTransform& here) {
  return (there.getOrigin() - here.getOrigin()).length() > kFarthestSlide_m ||
         std::abs(there.getRotation().dot(here.getRotation())) < std::cos(kFarthestTurn_rad / 2.0);
}

}  // namespace

PaperBody::PaperBody(const SceneBody& body, int index)
    : fixed_(body.fixed), tag_{-1, -1, index, nullptr, nullptr} {
  btVector3 moments(0, 0, 0);
  from_body_ = bullet::principalFrame(body, moments);
  start_ = toBt(body.pose * from_body_);
  if (fixed_) {
    addFixedParts(body);
  } else {
    addFreePart(body, moments);
  }
  putAtStart();
}

void PaperBody::addFixedParts(const SceneBody& body) {
  for (const Shape& shape : body.shapes) {
    const btTransform in_frame = toBt(from_body_.inverse() * shape.in_body);
    const bool soft = body.soft_m > 0.0;
    addPart(soft ? kSurface : kFixed, in_frame, keep(bullet::makeShape(shape)), 0.0, kNone,
            body.friction);
    if (!soft) continue;
    addPart(kCore, in_frame, keep(bullet::makeShape(coreOf(body, shape))), 0.0, kNone,
            body.friction);
  }
}

void PaperBody::addFreePart(const SceneBody& body, const btVector3& moments) {
  auto compound = std::make_unique<btCompoundShape>(false);
  for (const Shape& shape : body.shapes) {
    compound->addChildShape(toBt(from_body_.inverse() * shape.in_body),
                            keep(bullet::makeShape(shape)));
  }
  // A single shape whose frame equals Bullet's frame needs no compound shape.
  const Pose only = from_body_.inverse() * body.shapes.front().in_body;
  const bool bare = body.shapes.size() == 1 && only.translation_m.norm() == 0.0 &&
                    only.rotation == Eigen::Matrix3d::Identity();
  btCollisionShape* shape = bare ? shapes_.back().get() : keep(std::move(compound));
  addPart(kFree, btTransform::getIdentity(), shape, body.mass_kg, moments, body.friction);
  parts_.back().rigid->setDamping(body.linear_damping_per_s, 0.0);
}

btCollisionShape* PaperBody::keep(std::unique_ptr<btCollisionShape> shape) {
  return shapes_.emplace_back(std::move(shape)).get();
}

void PaperBody::addPart(int group, const btTransform& in_frame, btCollisionShape* shape,
                        double mass_kg, const btVector3& moments, double friction) {
  Part& part = parts_.emplace_back();
  part.group = group;
  part.in_frame = in_frame;
  part.shape = shape;
  part.rigid = std::make_unique<btRigidBody>(
      btRigidBody::btRigidBodyConstructionInfo(mass_kg, nullptr, shape, moments));
  part.rigid->setFriction(std::sqrt(friction));  // Bullet multiplies the friction of both bodies
  part.rigid->setUserPointer(&tag_);
  part.rigid->setActivationState(DISABLE_DEACTIVATION);
  if (fixed_) part.rigid->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
}

const btTransform& PaperBody::frame() const noexcept {
  return fixed_ ? frame_ : parts_.front().rigid->getWorldTransform();
}

bool PaperBody::place(const BodyPlacement& placement) noexcept {
  if (!isPose(placement)) return false;
  const btTransform at = bullet::placedAt(placement, from_body_);
  const bool elsewhere = isFarFrom(at, frame());
  put(at, toBt(placement.velocity_m_s.eigen()));
  return elsewhere;
}

void PaperBody::beginStep(double period_s) noexcept {
  if (!fixed_) return;
  for (Part& part : parts_) {
    btTransform before = part.rigid->getWorldTransform();
    before.getOrigin() -= velocity_ * period_s;
    part.rigid->setInterpolationWorldTransform(before);
  }
}

void PaperBody::endStep() noexcept {
  velocity_ = kNone;
}

void PaperBody::putAtStart() noexcept {
  put(start_, kNone);
}

void PaperBody::putAt(const btVector3& origin) noexcept {
  put(btTransform(start_.getBasis(), origin), kNone);
}

void PaperBody::put(const btTransform& at, const btVector3& velocity) noexcept {
  frame_ = at;
  velocity_ = velocity;
  for (Part& part : parts_) {
    btRigidBody& rigid = *part.rigid;
    rigid.setWorldTransform(at * part.in_frame);
    rigid.setInterpolationWorldTransform(rigid.getWorldTransform());
    rigid.setLinearVelocity(fixed_ ? kNone : velocity);
    rigid.setAngularVelocity(kNone);
    rigid.setInterpolationLinearVelocity(rigid.getLinearVelocity());
    rigid.setInterpolationAngularVelocity(kNone);
    rigid.clearForces();
    rigid.updateInertiaTensor();
  }
}

BodyState PaperBody::state() const noexcept {
  const btTransform& at = frame();
  const btQuaternion q = at.getRotation();
  const Eigen::Quaterniond turned =
      Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()) *
      Eigen::Quaterniond(Eigen::Matrix3d(from_body_.rotation.transpose()));
  const btRigidBody& rigid = *parts_.front().rigid;
  return {bullet::toVec3(at.getOrigin()), QuatXyzw::from(turned),
          bullet::toVec3(fixed_ ? velocity_ : rigid.getLinearVelocity()),
          bullet::toVec3(fixed_ ? kNone : rigid.getAngularVelocity())};
}

}  // namespace wholehand::bullet_paper
