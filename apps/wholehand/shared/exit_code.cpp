#include "apps/wholehand/shared/exit_code.hpp"

#include <cstdio>

namespace wholehand {

int exitCodeOf(bool faulted, bool interrupted) {
  if (faulted) return kExitFault;
  return interrupted ? kExitInterrupted : kExitDone;
}

int refuse(const Diagnostics& errors) {
  for (const Diagnostic& error : errors) {
    std::fprintf(stderr, "wholehand: %s\n", format(error).c_str());
  }
  return kExitBadInput;
}

int printNotShown(const Diagnostics& not_shown) {
  if (not_shown.empty()) return kExitDone;
  refuse(not_shown);
  return kExitNotWhole;
}

void printNotices(const Diagnostics& notices, int indent) {
  for (const Diagnostic& notice : notices) {
    std::printf("%*s%s\n", indent, "", format(notice).c_str());
  }
}

int printInterrupted() {
  std::printf("\nInterrupted: no results were written\n");
  return kExitInterrupted;
}

}  // namespace wholehand
