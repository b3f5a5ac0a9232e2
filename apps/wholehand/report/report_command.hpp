#pragma once

#include "loop/core/expected.hpp"

#include <string>

namespace wholehand {

struct ReportOptions {
  std::string recording;
  std::string page;         ///< HTML file
  std::string before = {};  ///< recording of the previous session; empty: none
};

/// Path of the report page in a folder.
[[nodiscard]] std::string pageIn(const std::string& folder);

/// Fails, with building instructions, when the report's template is missing. Call before a run.
[[nodiscard]] Expected<Done> checkReportTemplate();

/// Makes the report of a recording: one HTML file. Shows its progress on a terminal.
/// @param not_shown receives the parts of the recording that are not in the report; may be null
[[nodiscard]] Expected<Done> makeReport(const ReportOptions& options,
                                        Diagnostics* not_shown = nullptr);

/// `wholehand report` and `wholehand replay --report`. Returns the exit code.
int reportCommand(const ReportOptions& options);

}  // namespace wholehand
