#include "physics/bullet/near_filter.hpp"

#include "physics/bullet/bullet_types.hpp"
#include "physics/bullet/collider_tag.hpp"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletCollision/BroadphaseCollision/btOverlappingPairCache.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>

#include <algorithm>

namespace wholehand::bullet {
namespace {

const btCollisionObject* objectOf(const btBroadphaseProxy* proxy) {
  return static_cast<const btCollisionObject*>(proxy->m_clientObject);
}

// A distance changes by at most as much as one moves. Between two points `step_m` apart with
// distances d1 and d2 it is therefore never below (d1 + d2 - step_m) / 2.
double leastDistance(const Shape& shape, const btTransform& shape_in_world,
                     const btCollisionObject& capsule) {
  const auto* form = static_cast<const btCapsuleShape*>(capsule.getCollisionShape());
  const double half_m = form->getHalfHeight();
  const btTransform in_shape = shape_in_world.inverseTimes(capsule.getWorldTransform());
  const btVector3 along = in_shape.getBasis().getColumn(2) * half_m;
  const btVector3 middle = in_shape.getOrigin();
  const double at_a = signedDistance(shape, toEigen(middle - along));
  const double at_middle = signedDistance(shape, toEigen(middle));
  const double at_b = signedDistance(shape, toEigen(middle + along));
  return 0.5 * (at_middle + std::min(at_a, at_b) - half_m) - form->getRadius();
}

}  // namespace

NearFilter::NearFilter(btCollisionConfiguration* configuration, double threshold_m)
    : btCollisionDispatcher(configuration), threshold_m_(threshold_m) {
  manifolds_.reserve(4);
  setNearCallback(&NearFilter::onPair);
}

void NearFilter::onPair(btBroadphasePair& pair, btCollisionDispatcher& dispatcher,
                        const btDispatcherInfo& info) {
  auto& self = static_cast<NearFilter&>(dispatcher);
  // A pair that still holds a contact point is compared once more, so that Bullet lets go of it.
  if (self.apart(pair) && !self.touching(pair)) return;
  defaultNearCallback(pair, dispatcher, info);
}

bool NearFilter::apart(const btBroadphasePair& pair) const {
  const btCollisionObject* a = objectOf(pair.m_pProxy0);
  const btCollisionObject* b = objectOf(pair.m_pProxy1);
  const ColliderTag* tag_a = tagOf(a);
  const ColliderTag* tag_b = tagOf(b);
  if (tag_a == nullptr || tag_b == nullptr || tag_a->ofHand() == tag_b->ofHand()) return false;
  const Shape* shape = (tag_a->ofHand() ? tag_b : tag_a)->shape;
  if (shape == nullptr) return false;
  const btCollisionObject& capsule = tag_a->ofHand() ? *a : *b;
  const btCollisionObject& body = tag_a->ofHand() ? *b : *a;
  return leastDistance(*shape, body.getWorldTransform(), capsule) > threshold_m_;
}

bool NearFilter::touching(const btBroadphasePair& pair) {
  if (pair.m_algorithm == nullptr) return false;
  manifolds_.resize(0);
  pair.m_algorithm->getAllContactManifolds(manifolds_);
  for (int i = 0; i < manifolds_.size(); ++i) {
    if (manifolds_[i]->getNumContacts() > 0) return true;
  }
  return false;
}

}  // namespace wholehand::bullet
