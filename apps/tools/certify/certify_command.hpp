#pragma once

#include "rig/engines.hpp"

#include <string>

namespace wholehand {

struct CertifyOptions {
  std::string device, rendering, hand;
  std::string exercise = {};  ///< includes its walls; empty: none
  int level = 1;              ///< level of the exercise
  double rate_hz = 1000.0;
  std::string passport = {};  ///< passport of the device, certified at its worst corner; empty:
                              ///< none
  std::string json = {};      ///< JSON file; empty: none
  std::string charts = {};    ///< HTML file; empty: none
  bool impedance = false;     ///< predict and measure the felt impedance instead of stability
  std::string engine = defaultEngine();   ///< physics engine of the free-motion measurement
  double contact_stiffness_n_m = 1000.0;  ///< spring of the contact measurement
};

/// Certifies whether device, gains and hand form a stable loop with any passive person and object;
/// prints a table and one sentence. Returns the exit code: kExitDone if stable, kExitNotCertified
/// if not, kExitBadInput for an invalid file.
int certifyCommand(const CertifyOptions& options);

}  // namespace wholehand
