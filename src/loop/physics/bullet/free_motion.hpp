#pragma once

#include "loop/core/real_time.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace wholehand::bullet {

/// Moves a body by one step without forces. Its momentum is conserved, and it rotates as by
/// turnFree() (loop/physics/free_rotation.hpp). Bullet's own step conserves neither angular
/// momentum nor energy. Real-time safe.
WHOLEHAND_RT void moveFree(btRigidBody& body, double step_s) noexcept;

/// Kinetic energy ½ m v² + ½ ω·I ω [J]; 0 for a body that does not move. Real-time safe.
[[nodiscard]] WHOLEHAND_RT double kineticEnergy(const btRigidBody& body) noexcept;
/// The same for a given velocity of the centre of mass and a given angular velocity, world.
[[nodiscard]] WHOLEHAND_RT double kineticEnergy(const btRigidBody& body,
                                                const btVector3& velocity_m_s,
                                                const btVector3& spin_rad_s) noexcept;

}  // namespace wholehand::bullet
