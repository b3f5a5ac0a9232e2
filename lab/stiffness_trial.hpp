#pragma once

#include "loop/core/expected.hpp"
#include "rig/models.hpp"

#include <string>

namespace wholehand {

/// The largest stable stiffness of a contact, measured and predicted.
struct StableStiffness {
  /// Found by bisection with the complete renderer; 0: none within the search.
  double found_n_m = 0.0;
  double bound_n_m = 0.0;  ///< the certificate's bound against a rigid stop
  [[nodiscard]] double share() const { return bound_n_m > 0.0 ? found_n_m / bound_n_m : 0.0; }
};

/// A device of 0.5 kg and 1 N·s/m with one tick of output delay presses the back of the hand on a
/// fixed box, with γ = Φ = 0, and is then knocked. The result is the largest stiffness at which the
/// motion after the knock decays, to a hundredth of the bound. All other axes stand still.
/// @param files hand, device, rendering and patient; the device has an axis y
[[nodiscard]] Expected<StableStiffness> largestStableStiffness(const ModelFiles& files,
                                                               const std::string& engine,
                                                               double rate_hz);

}  // namespace wholehand
