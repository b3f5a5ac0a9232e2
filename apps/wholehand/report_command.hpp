#pragma once

#include <string>

namespace wholehand {

struct ReportOptions {
  std::string recording;
  std::string folder;
};

/// Makes a self-contained page of a recording. Returns the program's exit code.
int reportCommand(const ReportOptions& options);

}  // namespace wholehand
