#include "physics/bullet/collider_pairs.hpp"

#include "physics/bullet/bullet_types.hpp"
#include "physics/segment_distance.hpp"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

namespace wholehand::bullet {
namespace {

bool meetsHand(BulletBody::Meets meets, bool palm) {
  return meets == BulletBody::Meets::kAll || (meets == BulletBody::Meets::kDigits) == !palm;
}

bool meetsBodies(BulletBody::Meets meets) {
  return meets != BulletBody::Meets::kDigits;
}

bool keeps(const btPersistentManifold* manifold) {
  return manifold != nullptr && manifold->getNumContacts() > 0;
}

btCollisionObjectWrapper wrap(btCollisionObject& object) {
  return {nullptr, object.getCollisionShape(), &object, object.getWorldTransform(), -1, -1};
}

}  // namespace

ColliderPairs::ColliderPairs(btCollisionDispatcher& dispatcher, BulletHand& hand,
                             std::vector<BulletBody>& bodies, double threshold_m)
    : dispatcher_(dispatcher), hand_(hand), threshold_m_(threshold_m) {
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    for (const auto& collider : bodies[i].colliders()) {
      Target& target = targets_.emplace_back();
      target.collider = collider.get();
      for (int c = 0; c < hand.count(); ++c) {
        if (meetsHand(collider->meets, hand.isPalm(c))) target.capsules.push_back(c);
      }
      target.pairs.resize(target.capsules.size());
      if (!meetsBodies(collider->meets)) continue;
      for (std::size_t k = i + 1; k < bodies.size(); ++k) {
        if (!bodies[i].moves() && !bodies[k].moves()) continue;
        for (const auto& other : bodies[k].colliders()) {
          if (meetsBodies(other->meets)) body_pairs_.push_back({collider.get(), other.get(), {}});
        }
      }
    }
  }
}

ColliderPairs::~ColliderPairs() {
  for (Target& target : targets_) {
    for (Pair& pair : target.pairs) drop(pair);
  }
  for (BodyPair& pair : body_pairs_) drop(pair.pair);
}

void ColliderPairs::find() noexcept {
  for (Target& target : targets_) {
    if (target.kept > 0 || overlap(hand_.box(), target.collider->box)) findOfHand(target);
  }
  for (BodyPair& both : body_pairs_) {
    if (overlap(both.a->box, both.b->box)) {
      ask(both.pair, *both.a->object, *both.b->object);
    } else {
      drop(both.pair);
    }
  }
}

void ColliderPairs::findOfHand(Target& target) noexcept {
  Collider& collider = *target.collider;
  target.kept = 0;
  for (std::size_t i = 0; i < target.capsules.size(); ++i) {
    const int capsule = target.capsules[i];
    Pair& pair = target.pairs[i];
    if (!overlap(hand_.placed(capsule).box, collider.box)) {
      drop(pair);
    } else if (collider.tag.shape != nullptr) {
      touch(capsule, collider, pair);
    } else {
      ask(pair, hand_.object(capsule), *collider.object);
    }
    if (pair.manifold != nullptr || pair.algorithm != nullptr) ++target.kept;
  }
}

/// A capsule of the hand and a shape whose distance is a closed form.
void ColliderPairs::touch(int capsule, Collider& collider, Pair& pair) noexcept {
  const PlacedCapsule& placed = hand_.placed(capsule);
  const btTransform& frame = collider.object->getWorldTransform();
  const SegmentDistance is =
      contactDistance(*collider.tag.shape, toEigen(frame.invXform(toBt(placed.a_m))),
                      toEigen(frame.invXform(toBt(placed.b_m))), placed.radius_m, threshold_m_);
  const bool near = is.distance_m <= threshold_m_;
  if (!near && pair.manifold == nullptr) return;
  btCollisionObject& object = hand_.object(capsule);
  const btCollisionObjectWrapper a = wrap(object), b = wrap(*collider.object);
  btManifoldResult points(&a, &b);
  if (pair.manifold == nullptr)
    pair.manifold = dispatcher_.getNewManifold(&object, collider.object.get());
  points.setPersistentManifold(pair.manifold);
  if (near) {
    const Eigen::Vector3d on_axis_m = placed.a_m + is.along * (placed.b_m - placed.a_m);
    const btVector3 normal = frame.getBasis() * toBt(is.normal);
    points.addContactPoint(normal, toBt(on_axis_m) - normal * (is.distance_m + placed.radius_m),
                           is.distance_m);
  }
  points.refreshContactPoints();
  if (!near && !keeps(pair.manifold)) drop(pair);
}

/// Bullet's own narrow phase.
void ColliderPairs::ask(Pair& pair, btCollisionObject& first, btCollisionObject& second) noexcept {
  const btCollisionObjectWrapper a = wrap(first), b = wrap(second);
  if (pair.algorithm == nullptr) {
    pair.algorithm = dispatcher_.findAlgorithm(&a, &b, nullptr, BT_CONTACT_POINT_ALGORITHMS);
  }
  btManifoldResult points(&a, &b);
  pair.algorithm->processCollision(&a, &b, info_, &points);
}

void ColliderPairs::drop(Pair& pair) noexcept {
  if (pair.manifold != nullptr) dispatcher_.releaseManifold(pair.manifold);
  if (pair.algorithm != nullptr) {
    pair.algorithm->~btCollisionAlgorithm();
    dispatcher_.freeCollisionAlgorithm(pair.algorithm);
  }
  pair = Pair{};
}

}  // namespace wholehand::bullet
