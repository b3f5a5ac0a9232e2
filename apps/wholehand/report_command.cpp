#include "report_command.hpp"

#include "core/printable.hpp"
#include "exit_code.hpp"
#include "moment_picture.hpp"
#include "report/report.hpp"
#include "report/report_data.hpp"
#include "report/report_page.hpp"

#include <cmath>
#include <cstdio>
#include <unistd.h>

namespace wholehand {
namespace {

/// "Reading the recording: 42 %" on a terminal, rewritten in place; elsewhere nothing.
class ReadingLine {
 public:
  ReadingLine() : terminal_(::isatty(STDERR_FILENO) == 1) {}
  ~ReadingLine() {
    if (shown_ >= 0) std::fputs("\r\033[K", stderr);
  }
  ReadingLine(const ReadingLine&) = delete;
  ReadingLine& operator=(const ReadingLine&) = delete;

  void show(double share) {
    const int percent = static_cast<int>(std::lround(100.0 * share));
    if (!terminal_ || percent == shown_) return;
    shown_ = percent;
    std::fprintf(stderr, "\rReading the recording: %d %%", percent);
  }

 private:
  const bool terminal_;
  int shown_ = -1;
};

Expected<ReportData> readRecording(const std::string& recording) {
  ReadingLine line;
  return collectReport(recording, kReportPlotColumns, [&line](double share) { line.show(share); });
}

}  // namespace

Expected<Done> makeReport(const std::string& recording, const std::string& folder) {
  const auto data = readRecording(recording);
  if (!data) return data.errors();
  // The page first: it says what is wrong with a folder before anything is drawn.
  if (auto done = writeReport(*data, folder); !done) return done;
  const std::string png = folder + "/moment.png";
  auto drawn = drawTick(data->meta, data->largest_contact, recording, Moment{}, png);
  if (!drawn) return Done{};  // a recording without its files has no picture
  return writeReport(*data, folder, {{"The largest contact force, at " + *drawn, png}});
}

int reportCommand(const ReportOptions& options) {
  if (auto done = makeReport(options.recording, options.folder); !done) {
    return refuse(done.errors());
  }
  std::printf("%s/index.html\n", printable(options.folder).c_str());
  return kExitDone;
}

}  // namespace wholehand
