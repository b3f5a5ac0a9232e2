#include "loop/physics/bullet/contact_patch.hpp"

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include <algorithm>

// What a contact point of this step takes over from one of the last step.

namespace wholehand::bullet {
namespace {

constexpr double kAsBefore_m = 5e-3;  // a new point this near an old one replaces it

/// Data that a contact point passes on to its successor.
struct KeptPoint {
  btVector3 local_a, local_b, tangent1, tangent2;
  double impulse, impulse1, impulse2, spin, drift1, drift2;

  void take(const btManifoldPoint& from) {
    local_a = from.m_localPointA, local_b = from.m_localPointB;
    tangent1 = from.m_lateralFrictionDir1, tangent2 = from.m_lateralFrictionDir2;
    impulse = from.m_appliedImpulse;
    impulse1 = from.m_appliedImpulseLateral1, impulse2 = from.m_appliedImpulseLateral2;
    spin = from.m_prevRHS;
    drift1 = from.m_contactMotion1, drift2 = from.m_contactMotion2;
  }
  void give(btManifoldPoint& to) const {
    to.m_lateralFrictionDir1 = tangent1, to.m_lateralFrictionDir2 = tangent2;
    to.m_appliedImpulse = impulse;
    to.m_appliedImpulseLateral1 = impulse1, to.m_appliedImpulseLateral2 = impulse2;
    to.m_prevRHS = spin;
    to.m_contactMotion1 = drift1, to.m_contactMotion2 = drift2;
  }
};

}  // namespace

void inherit(btManifoldPoint& heir, const btManifoldPoint& from) noexcept {
  KeptPoint kept;
  kept.take(from);
  kept.give(heir);
}

void renew(btPersistentManifold& manifold, const ContactPatch& patch) noexcept {
  const btTransform& at_a = manifold.getBody0()->getWorldTransform();
  const btTransform& at_b = manifold.getBody1()->getWorldTransform();
  std::array<KeptPoint, ContactPatch::kMost> before;
  std::array<bool, ContactPatch::kMost> taken{};
  const int count = manifold.getNumContacts();
  for (int k = 0; k < count; ++k) before[k].take(manifold.getContactPoint(k));
  const double friction =
      btManifoldResult::calculateCombinedFriction(manifold.getBody0(), manifold.getBody1());
  while (manifold.getNumContacts() > patch.count) {
    manifold.removeContactPoint(manifold.getNumContacts() - 1);
  }
  for (int i = 0; i < patch.count; ++i) {
    // Writes the geometry of the point.
    const ContactPatch::Point& is = patch.points[i];
    const btVector3 on_a = is.on_b + is.normal * is.gap_m;
    if (i == manifold.getNumContacts()) {
      manifold.addManifoldPoint(btManifoldPoint(on_a, is.on_b, is.normal, is.gap_m), true);
    }
    btManifoldPoint& point = manifold.getContactPoint(i);
    point.m_localPointA = at_a.invXform(on_a);
    point.m_localPointB = at_b.invXform(is.on_b);
    point.m_positionWorldOnA = on_a;
    point.m_positionWorldOnB = is.on_b;
    point.m_normalWorldOnB = is.normal;
    point.m_distance1 = is.gap_m;
    point.m_combinedFriction = friction;
    // Finds the nearest old point and inherits its data.
    int same = -1;
    double least = kAsBefore_m * kAsBefore_m;
    for (int k = 0; k < count; ++k) {
      if (taken[k]) continue;
      const double away = std::min((before[k].local_a - point.m_localPointA).length2(),
                                   (before[k].local_b - point.m_localPointB).length2());
      if (away >= least) continue;
      least = away;
      same = k;
    }
    if (same >= 0) {
      taken[same] = true;
      if (same != i) before[same].give(point);
      continue;
    }
    KeptPoint none{};
    btPlaneSpace1(is.normal, none.tangent1, none.tangent2);
    none.give(point);
  }
}

}  // namespace wholehand::bullet
