#pragma once

#include "assembly/engines.hpp"

#include <string>

namespace wholehand {

struct CertifyOptions {
  std::string device, rendering, hand;
  std::string exercise = {};  ///< whose walls are borne, too; empty: none
  int level = 1;              ///< of the exercise
  double rate_hz = 1000.0;
  std::string passport = {};  ///< of the device: its worst corner is judged; empty: none
  std::string json = {};      ///< empty: none
  std::string charts = {};    ///< empty: none
  bool impedance = false;  ///< what the person feels, predicted and measured, in place of stability
  std::string engine = defaultEngine();   ///< that free motion is felt in
  double contact_stiffness_n_m = 1000.0;  ///< of the spring in which it is felt, too
};

/// Judges whether device, gains and hand make a stable loop with any passive person and object, and
/// says so as a table and one sentence. Returns the program's exit code: kExitDone where they do,
/// kExitNotCertified where not, kExitBadInput where a file is not well formed.
int certifyCommand(const CertifyOptions& options);

}  // namespace wholehand
