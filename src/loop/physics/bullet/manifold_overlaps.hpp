#pragma once

#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/hand_overlaps.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionDispatcher.h>

namespace wholehand::bullet {

/// Adds the overlaps that Bullet found between the hand and the bodies.
inline void addOverlaps(btCollisionDispatcher& dispatcher, HandOverlaps& found) {
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    const ColliderTag* a = tagOf(manifold.getBody0());
    const ColliderTag* b = tagOf(manifold.getBody1());
    if (a->ofHand() == b->ofHand()) continue;
    const int capsule = (a->ofHand() ? a : b)->capsule;
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      found.add((a->ofHand() ? b : a)->body, capsule, -manifold.getContactPoint(k).getDistance());
    }
  }
}

}  // namespace wholehand::bullet
