#include "impedance_command.hpp"

#include "chart_file.hpp"
#include "exit_code.hpp"
#include "files/text_file.hpp"
#include "impedance_chart.hpp"
#include "impedance_text.hpp"
#include "json_text.hpp"

#include <cstdio>
#include <unistd.h>

namespace wholehand {
namespace {

/// Progress line, rewritten in place on a terminal; silent elsewhere.
void showProgress(const std::string& what, int done, int all) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::fprintf(stderr, "\r\033[Kmeasuring %s (%d of %d)", what.c_str(), done + 1, all);
}

void endProgress() {
  if (isatty(STDERR_FILENO) != 0) std::fputs("\r\033[K", stderr);
}

}  // namespace

int impedanceCommand(const Models& models, const ImpedanceOptions& options, const std::string& json,
                     const std::string& charts) {
  if (auto ready = prepareCharts(charts, {json}); !ready) return refuse(ready.errors());
  const auto report = measureImpedance(models, options, showProgress);
  endProgress();
  if (!report) return refuse(report.errors());
  std::fputs(impedanceText(*report).c_str(), stdout);
  if (!json.empty()) {
    nlohmann::ordered_json all;
    all["rate_hz"] = 1.0 / report->period_s;
    all["device"] = report->device;
    all["rendering"] = report->rendering;
    all["hand"] = report->hand;
    all["impedance"] = impedanceJson(*report);
    if (auto done = writeText(json, jsonText(all, 1)); !done) return refuse(done.errors());
  }
  if (!charts.empty()) {
    const auto done = writeCharts(impedanceChart(*report), charts);
    if (!done) return refuse(done.errors());
  }
  return report->asPredicted() ? kExitDone : kExitNotCertified;
}

}  // namespace wholehand
