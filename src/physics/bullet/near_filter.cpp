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

// A segment between two points with their distances to a shape.
struct Stretch {
  Eigen::Vector3d a_m, b_m;
  double at_a_m, at_b_m;
};

// A distance changes by at most as much as one moves: between two points it is never below half of
// the sum of theirs less the way between them. Halving the way tells more; twice is enough.
bool everywhereBeyond(const Shape& shape, const Stretch& s, double limit_m, int halvings) {
  const double least_m = 0.5 * (s.at_a_m + s.at_b_m - (s.b_m - s.a_m).norm());
  if (least_m > limit_m) return true;
  if (halvings == 0 || std::min(s.at_a_m, s.at_b_m) <= limit_m) return false;
  const Eigen::Vector3d middle_m = 0.5 * (s.a_m + s.b_m);
  const double at_middle_m = signedDistance(shape, middle_m);
  return everywhereBeyond(shape, {s.a_m, middle_m, s.at_a_m, at_middle_m}, limit_m, halvings - 1) &&
         everywhereBeyond(shape, {middle_m, s.b_m, at_middle_m, s.at_b_m}, limit_m, halvings - 1);
}

bool beyond(const Shape& shape, const btTransform& shape_in_world, const btCollisionObject& capsule,
            double gap_m) {
  constexpr int kHalvings = 2;
  const auto* form = static_cast<const btCapsuleShape*>(capsule.getCollisionShape());
  const btTransform in_shape = shape_in_world.inverseTimes(capsule.getWorldTransform());
  const btVector3 along = in_shape.getBasis().getColumn(2) * form->getHalfHeight();
  const Eigen::Vector3d a_m = toEigen(in_shape.getOrigin() - along);
  const Eigen::Vector3d b_m = toEigen(in_shape.getOrigin() + along);
  const Stretch axis{a_m, b_m, signedDistance(shape, a_m), signedDistance(shape, b_m)};
  return everywhereBeyond(shape, axis, form->getRadius() + gap_m, kHalvings);
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
  return beyond(*shape, body.getWorldTransform(), capsule, threshold_m_);
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
