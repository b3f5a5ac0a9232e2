#pragma once

#include "core/expected.hpp"

namespace wholehand {

/// What the program tells the shell.
enum ExitCode : int {
  kExitDone = 0,
  kExitDifferent = 1,     ///< replay --resimulate found a difference
  kExitNotCertified = 1,  ///< certify says no
  kExitNotFit = 1,        ///< doctor: this machine may not drive a device; device conform
  kExitBadInput = 2,      ///< bad usage or a bad file
  kExitFault = 3,         ///< a fault stopped the run
  kExitFailed = 4,        ///< the program itself: no memory, a folder that was taken away
  kExitInterrupted = 130
};

/// How a run that took place ended; a fault weighs more than Ctrl-C.
[[nodiscard]] int endOf(bool faulted, bool interrupted);

/// Prints every fault to standard error, one a line, and returns kExitBadInput.
int refuse(const Diagnostics& errors);

}  // namespace wholehand
