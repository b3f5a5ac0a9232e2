#include "station/report_child.hpp"

#include "process/child_process.hpp"
#include "runtime/interrupt_scope.hpp"

#include <cstring>

namespace wholehand {
namespace {

/// A recording may claim texts of up to 2 GB.
constexpr std::uint64_t kMemory_bytes = 2ULL << 30;
constexpr int kNotWhole = 1;  ///< exit code: the page is written, and says what it does not show

}  // namespace

Expected<Done> ReportChild::make(const std::string& recording, const std::string& folder) {
  const auto refusal = [&](std::string problem) {
    return Diagnostic{recording,
                      0,
                      "",
                      "",
                      std::move(problem),
                      "try: wholehand report " + recording + " --out " + folder};
  };
  const auto ends = [this] { return ending_.load() || InterruptScope::interrupted(); };
  if (ends()) return refusal("no report is made: the program is ending");
  const ChildLimits limits{.time = longest_, .memory_bytes = kMemory_bytes, .idle = true};
  const ChildResult child = runChild(program_.empty() ? "/proc/self/exe" : program_,
                                     {"report", recording, "--out", folder}, limits, ends);
  switch (child.ending) {
    case ChildEnding::kNotStarted:
      return refusal(std::string("no report could be made: ") + std::strerror(child.code));
    case ChildEnding::kLate:
      return refusal("no report was made in time");
    case ChildEnding::kStopped:
      return refusal("no report is made: the program is ending");
    case ChildEnding::kSignal:
      return refusal(std::string("ended the program that made its report: ") +
                     ::strsignal(child.code));
    case ChildEnding::kTooMuchOutput:
    case ChildEnding::kExited:
      break;
  }
  if (child.code != 0 && child.code != kNotWhole) return refusal("no report could be made");
  return Done{};
}

}  // namespace wholehand
