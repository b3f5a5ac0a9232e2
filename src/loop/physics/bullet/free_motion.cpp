#include "loop/physics/bullet/free_motion.hpp"

#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/free_rotation.hpp"

#include <cmath>

namespace wholehand::bullet {
namespace {

/// The rotation that a constant angular velocity makes in a time.
btQuaternion turnBy(const btVector3& spin, double seconds) {
  const double rate = spin.length();
  if (rate * seconds < 1e-12) return btQuaternion(0.0, 0.0, 0.0, 1.0);
  const btVector3 axis = spin * (std::sin(0.5 * rate * seconds) / rate);
  return {axis.x(), axis.y(), axis.z(), std::cos(0.5 * rate * seconds)};
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
  const bool even = inverse.x() == inverse.y() && inverse.y() == inverse.z();
  if (even || inverse.x() * inverse.y() * inverse.z() == 0.0) {
    btQuaternion turned = turnBy(spin, step_s) * pose;
    turned.normalize();
    at.setRotation(turned);
    body.proceedToTransform(at);
    return;
  }
  const FreeRotation moved =
      turnFree({Eigen::Quaterniond(pose.w(), pose.x(), pose.y(), pose.z()), toEigen(spin)},
               {1.0 / inverse.x(), 1.0 / inverse.y(), 1.0 / inverse.z()}, step_s);
  at.setRotation({moved.axes.x(), moved.axes.y(), moved.axes.z(), moved.axes.w()});
  body.proceedToTransform(at);
  body.setAngularVelocity(toBt(moved.spin_rad_s));
}

double kineticEnergy(const btRigidBody& body) noexcept {
  return kineticEnergy(body, body.getLinearVelocity(), body.getAngularVelocity());
}

double kineticEnergy(const btRigidBody& body, const btVector3& velocity_m_s,
                     const btVector3& spin_rad_s) noexcept {
  if (body.getInvMass() == 0.0) return 0.0;
  double twice_j = velocity_m_s.length2() / body.getInvMass();
  if (!spin_rad_s.isZero()) {
    const btVector3 spin = spin_rad_s * body.getWorldTransform().getBasis();
    const btVector3& inverse = body.getInvInertiaDiagLocal();
    for (int k = 0; k < 3; ++k) {
      if (inverse[k] > 0.0) twice_j += spin[k] * spin[k] / inverse[k];
    }
  }
  return 0.5 * twice_j;
}

}  // namespace wholehand::bullet
