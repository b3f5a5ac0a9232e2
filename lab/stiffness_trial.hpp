#pragma once

#include "loop/core/expected.hpp"
#include "rig/models.hpp"

#include <string>

namespace wholehand {

/// The largest stable stiffness of a contact, found and predicted.
struct StableStiffness {
  double found_n_m = 0.0;  ///< by bisection through the whole renderer; 0: none within the search
  double bound_n_m = 0.0;  ///< of the certificate against a rigid stop
  [[nodiscard]] double share() const { return bound_n_m > 0.0 ? found_n_m / bound_n_m : 0.0; }
};

/// The back of the hand is pressed on a fixed box by a device of 0.5 kg and 1 N·s/m with one tick
/// of output delay, γ = Φ = 0, and knocked; the stiffness is the largest at which the knock dies
/// away, to a hundredth of the bound. All other axes stand still.
/// @param files hand, device, rendering and patient; the device has an axis y
[[nodiscard]] Expected<StableStiffness> largestStableStiffness(const ModelFiles& files,
                                                               const std::string& engine,
                                                               double rate_hz);

}  // namespace wholehand
