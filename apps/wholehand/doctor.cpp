#include "doctor.hpp"

#include "doctor_findings.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <sys/ioctl.h>
#include <unistd.h>

namespace wholehand {
namespace {

/// How the report looks: colours or none, and where lines end.
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

  void finding(const Finding& f) const {
    std::printf("  %s%s%s %s%s", code(f.good ? "\033[32m" : "\033[33m"), f.good ? "✓" : "!",
                code("\033[0m"), f.what.c_str(), padding(f.what).c_str());
    wrapped(f.fact, "");
    if (!f.good && !f.remedy.empty()) {
      std::printf("%s%s", std::string(kIndent, ' ').c_str(), code("\033[2m"));
      wrapped(f.remedy, "→ ");
      std::printf("%s", code("\033[0m"));
    }
  }

  void verdict(bool good, const std::string& text) const {
    std::printf("\n%s%s%s\n", code(good ? "\033[1;32m" : "\033[1;33m"), text.c_str(),
                code("\033[0m"));
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
      std::printf("%s%s", first ? "" : " ", word.c_str());
      column += word.size() + (first ? 0 : 1);
      first = false;
    }
    std::printf("\n");
  }

  bool colour_ = false;
  std::size_t width_ = kWidest;
};

void printVerdict(const Printer& printer, const Findings& findings) {
  const auto blocked = [&](Blocks what) {
    return std::any_of(findings.begin(), findings.end(),
                       [&](const Finding& f) { return !f.good && f.blocks == what; });
  };
  if (blocked(Blocks::kEverything)) {
    printer.verdict(false, "This machine cannot run the loop at all: see the lines marked !.");
  } else if (blocked(Blocks::kDevice)) {
    printer.verdict(false,
                    "This machine is fine for simulation. It must not drive a device yet: mend the "
                    "lines marked ! first.");
  } else {
    printer.verdict(true,
                    "This machine may drive a device. Before a person holds it, measure wake-ups "
                    "for an hour under load.");
  }
}

}  // namespace

int runDoctor(const std::filesystem::path& packages_file) {
  const Printer printer;
  Findings all;
  const auto show = [&](const char* heading, const Findings& findings) {
    printer.heading(heading);
    for (const Finding& f : findings) {
      printer.finding(f);
    }
    std::fflush(stdout);
    all.insert(all.end(), findings.begin(), findings.end());
  };
  show("Machine", findingsAboutMachine());
  show("Software", findingsAboutSoftware(packages_file));
  // Last: it takes two seconds, and what stands above can be read meanwhile.
  show("Loop, tried for two seconds", findingsAboutLoop());
  printVerdict(printer, all);
  return 0;
}

}  // namespace wholehand
