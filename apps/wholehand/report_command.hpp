#pragma once

#include "core/expected.hpp"

#include <string>

namespace wholehand {

struct ReportOptions {
  std::string recording;
  std::string page;         ///< HTML file
  std::string before = {};  ///< recording of the session before; empty: none
};

/// The page of a report in its folder.
[[nodiscard]] std::string pageIn(const std::string& folder);

/// Where there is no template of a report: how it is built. Asked before a run begins.
[[nodiscard]] Expected<Done> checkReportTemplate();

/// Makes a page of a recording: one HTML file. Says on a terminal how far it is.
[[nodiscard]] Expected<Done> makeReport(const ReportOptions& options);

/// `wholehand report` and `wholehand replay --report`. Returns the program's exit code.
int reportCommand(const ReportOptions& options);

}  // namespace wholehand
