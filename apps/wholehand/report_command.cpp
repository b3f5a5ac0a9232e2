#include "report_command.hpp"

#include "exit_code.hpp"
#include "report/report.hpp"

#include <cstdio>

namespace wholehand {

int reportCommand(const ReportOptions& options) {
  if (auto done = writeReport(options.recording, options.folder); !done) {
    return refuse(done.errors());
  }
  std::printf("%s/index.html\n", options.folder.c_str());
  return kExitDone;
}

}  // namespace wholehand
