#include "physics/bullet/free_motion.hpp"

#include <cmath>

namespace wholehand::bullet {
namespace {

constexpr int kMostIterations = 20;
constexpr double kExact = 1e-14;  // of the spin

/// The turn of a spin held for a time.
btQuaternion turnBy(const btVector3& spin, double seconds) {
  const double rate = spin.length();
  if (rate * seconds < 1e-12) return btQuaternion(0.0, 0.0, 0.0, 1.0);
  const btVector3 axis = spin * (std::sin(0.5 * rate * seconds) / rate);
  return {axis.x(), axis.y(), axis.z(), std::cos(0.5 * rate * seconds)};
}

/// Spin of a body of this momentum in a pose.
btVector3 spinOf(const btVector3& momentum, const btQuaternion& pose,
                 const btVector3& inverse_inertia) {
  const btMatrix3x3 axes(pose);
  return axes * (momentum * axes * inverse_inertia);
}

}  // namespace

void moveFree(btRigidBody& body, double step_s) noexcept {
  btTransform at = body.getWorldTransform();
  at.setOrigin(at.getOrigin() + body.getLinearVelocity() * step_s);
  const btVector3 spin = body.getAngularVelocity();
  if (spin.isZero()) {
    body.proceedToTransform(at);
    return;
  }
  const btQuaternion pose = at.getRotation();
  const btVector3 inverse = body.getInvInertiaDiagLocal();
  btVector3 middle = spin, after = spin;
  btQuaternion turned;
  const bool even = inverse.x() == inverse.y() && inverse.y() == inverse.z();
  if (even || inverse.x() * inverse.y() * inverse.z() == 0.0) {
    turned = turnBy(spin, step_s) * pose;
  } else {
    const btMatrix3x3 axes(pose);
    const btVector3 inertia(1.0 / inverse.x(), 1.0 / inverse.y(), 1.0 / inverse.z());
    const btVector3 momentum = axes * (spin * axes * inertia);
    for (int i = 0; i < kMostIterations; ++i) {
      const btVector3 next = spinOf(momentum, turnBy(middle, 0.5 * step_s) * pose, inverse);
      const bool there = (next - middle).length2() <= kExact * kExact * next.length2();
      middle = next;
      if (there) break;
    }
    turned = turnBy(middle, step_s) * pose;
    after = spinOf(momentum, turned, inverse);
  }
  turned.normalize();
  at.setRotation(turned);
  body.proceedToTransform(at);
  body.setAngularVelocity(after);
}

}  // namespace wholehand::bullet
