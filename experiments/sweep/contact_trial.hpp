#pragma once

#include "experiments/grasp_trial.hpp"
#include "loop/core/expected.hpp"

namespace wholehand {

/// What a hand did that closes on a fixed object and presses until 3.3 s.
struct ContactResult {
  /// No fault, and what is felt came to rest: noise of at most kRests_n over the last 0.3 s.
  bool stable = false;
  bool certified = false;      ///< by the certificate of these gains and this device
  double margin = 0.0;         ///< of the certificate; >= 1 passes
  double noise_n = 0.0;        ///< of the felt effort over the last 0.3 s: worst axis, rms
  double penetration_m = 0.0;  ///< deepest overlap
  bool faulted = false;

  /// A rest is quieter than the smallest force that fingers feel [N].
  static constexpr double kRests_n = 0.05;
};

/// Runs a contact on the simulated clock.
[[nodiscard]] Expected<ContactResult> runContact(const GraspTrial& trial, const ModelFiles& files,
                                                 const TrialSetup& setup);

}  // namespace wholehand
