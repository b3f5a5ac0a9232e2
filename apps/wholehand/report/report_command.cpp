#include "apps/wholehand/report/report_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "files/page/chart_page.hpp"
#include "loop/core/printable.hpp"
#include "replay/recording_report.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <unistd.h>

namespace wholehand {
namespace {

/// Progress "Reading the recording: 42 %", rewritten in place on a terminal; silent elsewhere.
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

Expected<std::string> reportTemplate() {
  return readPageTemplate(shippedFile("web/dist/report.html"));
}

}  // namespace

std::string pageIn(const std::string& folder) {
  return folder.empty() ? "index.html" : folder + "/index.html";
}

Expected<Done> checkReportTemplate() {
  const auto page_template = reportTemplate();
  if (!page_template) return page_template.errors();
  return Done{};
}

Expected<Done> makeReport(const ReportOptions& options, Diagnostics* not_shown) {
  // The template is checked first, so that a recording of an hour is not read in vain.
  const auto page_template = reportTemplate();
  if (!page_template) return page_template.errors();
  ReadingLine line;
  const auto data = reportData(
      options.recording, options.before, [&line](double share) { line.show(share); },
      kLongRecording_ticks, not_shown);
  if (!data) return data.errors();
  return writePage(*page_template, *data, options.page);
}

int reportCommand(const ReportOptions& options) {
  Diagnostics not_shown;
  if (auto done = makeReport(options, &not_shown); !done) return refuse(done.errors());
  std::printf("%s\n", printable(options.page).c_str());
  return printNotShown(not_shown);
}

}  // namespace wholehand
