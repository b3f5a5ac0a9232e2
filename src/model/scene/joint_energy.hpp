#pragma once

#include "core/real_time.hpp"
#include "model/scene/scene_joint.hpp"

#include <cmath>

namespace wholehand {

/// Energy that spring and latch of a joint store at q [J]; 0 at the spring's rest and in a detent.
/// Real-time safe.
[[nodiscard]] WHOLEHAND_RT inline double storedEnergy(const SceneJoint& joint, double q) noexcept {
  const double stretch = q - joint.spring_rest;
  return 0.5 * joint.spring_stiffness * stretch * stretch +
         0.5 * joint.latch_energy_j * (1.0 - std::cos(joint.latch_wave * (q - joint.latch_at)));
}

}  // namespace wholehand
