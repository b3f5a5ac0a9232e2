#include "apps/wholehand/doctor/doctor.hpp"

#include "apps/wholehand/doctor/doctor_findings.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "loop/core/printable.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

namespace wholehand {
namespace {

/// Output format: colours and line width.
class Printer {
 public:
  Printer() {
    const bool terminal = isatty(STDOUT_FILENO) == 1;
    const char* no_color = std::getenv("NO_COLOR");
    colour_ = terminal && (no_color == nullptr || *no_color == '\0');
    winsize size{};
    if (terminal && ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col >= 40) {
      width_ = std::min<std::size_t>(size.ws_col, kWidest);
    }
  }

  void heading(const char* text) const {
    std::printf("\n%s%s%s\n", code("\033[1m"), text, code("\033[0m"));
  }

  void finding(const DoctorFinding& f) const {
    std::printf("  %s%s%s %s%s", code(f.good ? "\033[32m" : "\033[33m"), f.good ? "✓" : "!",
                code("\033[0m"), printable(f.what).c_str(), padding(f.what).c_str());
    wrapped(f.fact, "");
    if (!f.good && !f.remedy.empty()) {
      std::printf("%s%s", std::string(kIndent, ' ').c_str(), code("\033[2m"));
      wrapped(f.remedy, "→ ");
      std::printf("%s", code("\033[0m"));
    }
  }

  /// Lateness: one line per bin, without empty bins at the end.
  void histogram(const WakeUpStatistics& s) const {
    const std::uint64_t most = *std::max_element(s.classes.begin(), s.classes.end());
    constexpr double kBar = 50.0;
    for (std::size_t i = 0; i < s.classes.size(); ++i) {
      if (s.classes[i] == 0) continue;
      const bool last = i == kLatenessClass_ns.size();
      const auto edge_us = static_cast<long long>(kLatenessClass_ns[last ? i - 1 : i] / 1000);
      const auto length =
          static_cast<int>(kBar * static_cast<double>(s.classes[i]) / static_cast<double>(most));
      std::printf("  %s %5lld µs late %7llu %s%s%s\n", last ? "from " : "below", edge_us,
                  static_cast<unsigned long long>(s.classes[i]), code("\033[2m"),
                  std::string(static_cast<std::size_t>(std::max(length, 1)), '#').c_str(),
                  code("\033[0m"));
    }
  }

  void verdict(bool good, const std::string& text) const {
    std::printf("\n%s%s%s\n", code(good ? "\033[1;32m" : "\033[1;33m"),
                printable(text, 1000).c_str(), code("\033[0m"));
  }

 private:
  static constexpr std::size_t kWidest = 100;
  static constexpr std::size_t kName = 18;
  static constexpr std::size_t kIndent = kName + 5;

  [[nodiscard]] const char* code(const char* escape) const { return colour_ ? escape : ""; }
  static std::string padding(const std::string& name) {
    return std::string(name.size() < kName ? kName - name.size() + 1 : 1, ' ');
  }

  /// Prints words, continuing under the first one, to the width of the terminal.
  void wrapped(const std::string& text, const std::string& lead) const {
    const std::size_t hang = lead.empty() ? 0 : 2;  // "→ " takes two columns, not four bytes
    std::printf("%s", lead.c_str());
    std::size_t column = kIndent + hang;
    std::istringstream words(text);
    std::string word;
    bool first = true;
    while (words >> word) {
      if (!first && column + 1 + word.size() > width_) {
        std::printf("\n%s", std::string(kIndent + hang, ' ').c_str());
        column = kIndent + hang;
        first = true;
      }
      const std::string shown = printable(word);
      std::printf("%s%s", first ? "" : " ", shown.c_str());
      column += shown.size() + (first ? 0 : 1);
      first = false;
    }
    std::printf("\n");
  }

  bool colour_ = false;
  std::size_t width_ = kWidest;
};

/// Counts the seconds on a terminal; silent elsewhere.
void showProgress(std::size_t done) {
  if (isatty(STDOUT_FILENO) != 1) return;
  std::printf("\r  %.1f of %.0f s", static_cast<double>(done) * 1e-9 * kDoctorPeriod_ns,
              kDoctorWakeUps * 1e-9 * kDoctorPeriod_ns);
  std::fflush(stdout);
}

Findings tryLoop(const Printer& printer) {
  PeriodicThreadConfig config;
  config.period_ns = kDoctorPeriod_ns;
  const auto probe = probeWakeUps(config, kDoctorWakeUps, showProgress);
  if (isatty(STDOUT_FILENO) == 1) std::printf("\r\033[K");
  if (!probe) return findingsAboutNoLoop(probe.errors());
  printer.histogram(probe->statistics);
  return findingsAboutLoop(*probe, kDoctorPeriod_ns);
}

}  // namespace

int runDoctor(const std::filesystem::path& packages_file) {
  const Printer printer;
  Findings all;
  const auto show = [&](const Findings& findings) {
    for (const DoctorFinding& f : findings) {
      printer.finding(f);
    }
    std::fflush(stdout);
    all.insert(all.end(), findings.begin(), findings.end());
  };
  printer.heading("Machine");
  show(findingsAboutMachine(machineFacts(), geteuid() == 0));
  printer.heading("Software");
  show(findingsAboutSoftware(packages_file));
  const Findings adapters = findingsAboutAdapters("/sys/bus/usb-serial/devices");
  if (!adapters.empty()) {
    printer.heading("Serial adapters");
    show(adapters);
  }
  // Last, since it takes time and the lines above can be read meanwhile.
  printer.heading("Loop, woken 1000 times a second for 3 seconds");
  std::fflush(stdout);
  show(tryLoop(printer));
  const Verdict verdict = verdictOf(all);
  printer.verdict(verdict.fit, verdict.sentence);
  return verdict.fit ? kExitDone : kExitNotFit;
}

}  // namespace wholehand
