#pragma once

#include "experiments/grasp_trial.hpp"
#include "loop/core/expected.hpp"

namespace wholehand {

/// Result of a hand that closes on a fixed object and presses until 3.3 s.
struct ContactResult {
  /// True without a fault and if the rendered effort came to rest: noise of at most kRests_n over
  /// the last 0.3 s.
  bool stable = false;
  bool certified = false;      ///< the certificate passes for these gains and this device
  double margin = 0.0;         ///< margin of the certificate; >= 1 passes
  double noise_n = 0.0;        ///< rms of the rendered effort over the last 0.3 s, worst axis
  double penetration_m = 0.0;  ///< deepest overlap
  bool faulted = false;

  /// Noise limit of a hand at rest, below the smallest force that fingers perceive [N].
  static constexpr double kRests_n = 0.05;
};

/// Runs a contact on the simulated clock.
[[nodiscard]] Expected<ContactResult> runContact(const GraspTrial& trial, const ModelFiles& files,
                                                 const TrialSetup& setup);

}  // namespace wholehand
