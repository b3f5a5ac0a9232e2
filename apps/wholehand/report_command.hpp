#pragma once

#include "core/expected.hpp"

#include <string>

namespace wholehand {

struct ReportOptions {
  std::string recording;
  std::string folder;
};

/// Makes a self-contained page of a recording, with a picture of its strongest moment.
[[nodiscard]] Expected<Done> makeReport(const std::string& recording, const std::string& folder);

/// `wholehand report`. Returns the program's exit code.
int reportCommand(const ReportOptions& options);

}  // namespace wholehand
