#pragma once

#include "core/real_time.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace wholehand::bullet {

/// Moves a body by one step without forces. It keeps its momentum, and its angular momentum
/// L = R I Rᵀ ω to rounding; the turn follows the implicit midpoint rule, which is symmetric in
/// time: its energy error is of second order in the turn of a step and does not grow (Hairer,
/// Lubich, Wanner, Geometric Numerical Integration, VII.5). Bullet's own step loses both. Real-time
/// safe.
WHOLEHAND_RT void moveFree(btRigidBody& body, double step_s) noexcept;

}  // namespace wholehand::bullet
