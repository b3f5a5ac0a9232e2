#pragma once

#include "loop/core/expected.hpp"

namespace wholehand {

/// Exit codes of the program.
enum ExitCode : int {
  kExitDone = 0,
  kExitDifferent = 1,     ///< replay --resimulate found a difference
  kExitNotCertified = 1,  ///< certify: not certified
  kExitNotFit = 1,        ///< doctor, device conform, validate --admit: not fit
  kExitNotWhole = 1,      ///< replay, report: not all of the recording is shown
  kExitNotAlike = 1,      ///< decompose: the pieces' volume differs from the mesh's
  kExitNotMoved = 1,      ///< experiment touch: a joint did not move through its range
  kExitBadInput = 2,      ///< bad usage or a bad file
  kExitFault = 3,         ///< a fault stopped the run
  kExitFailed = 4,        ///< internal failure: no memory, a folder that was removed
  kExitInterrupted = 130
};

/// Exit code of a run that took place; a fault takes precedence over Ctrl-C.
[[nodiscard]] int exitCodeOf(bool faulted, bool interrupted);

/// Prints every error to standard error, one per line, and returns kExitBadInput.
int refuse(const Diagnostics& errors);

/// Prints the parts of a recording that are not shown to standard error, one per line. Returns
/// kExitNotWhole if there are any, else kExitDone.
int printNotShown(const Diagnostics& not_shown);

/// Prints notices about valid files, one per line, indented by `indent` blanks.
void printNotices(const Diagnostics& notices, int indent);

/// Prints that Ctrl-C left no results, and returns kExitInterrupted.
int printInterrupted();

}  // namespace wholehand
