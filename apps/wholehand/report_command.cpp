#include "report_command.hpp"

#include "core/printable.hpp"
#include "exit_code.hpp"
#include "moment_picture.hpp"
#include "report/report.hpp"

#include <cstdio>

namespace wholehand {

Expected<Done> makeReport(const std::string& recording, const std::string& folder) {
  // The page first: it says what is wrong with a recording or a folder before anything is drawn.
  if (auto done = writeReport(recording, folder); !done) return done;
  const std::string png = folder + "/moment.png";
  auto drawn = drawMoment(recording, Moment{}, png);
  if (!drawn) return Done{};  // a recording without its files, or of no tick, has no picture
  return writeReport(recording, folder, {{"The largest contact force, at " + *drawn, png}});
}

int reportCommand(const ReportOptions& options) {
  if (auto done = makeReport(options.recording, options.folder); !done) {
    return refuse(done.errors());
  }
  std::printf("%s/index.html\n", printable(options.folder).c_str());
  return kExitDone;
}

}  // namespace wholehand
