#include "station/reports.hpp"

#include "files/process/child_process.hpp"
#include "files/text/text_file.hpp"
#include "loop/runtime/interrupt_scope.hpp"

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sys/stat.h>
#include <system_error>

namespace wholehand {

namespace {

/// Memory limit of the child process. A malicious recording may declare texts of up to 2 GB.
constexpr std::uint64_t kMemory_bytes = 2ULL << 30;
constexpr int kNotWhole = 1;  ///< exit code: the page was written but is incomplete, and says what
                              ///< is missing

/// The file that marks a page as finished, and holds the identity of its recording.
std::string markIn(const std::string& folder) {
  return folder + "/recording.txt";
}

/// Device, inode, size and modification time of a recording; empty when there is no such file.
std::string identityOf(const std::string& recording) {
  struct stat found {};
  if (::stat(recording.c_str(), &found) != 0) return {};
  return fmt::format("device {} inode {} bytes {} changed {}.{:09d}\n", found.st_dev, found.st_ino,
                     found.st_size, found.st_mtim.tv_sec, found.st_mtim.tv_nsec);
}

bool isReportOf(const std::string& folder, const std::string& identity) {
  std::error_code error;
  if (identity.empty() || !std::filesystem::exists(folder + "/index.html", error)) return false;
  std::ifstream in(markIn(folder));
  return std::string(std::istreambuf_iterator<char>(in), {}) == identity;
}

}  // namespace

Expected<Done> ReportChild::make(const std::string& recording, const std::string& folder) {
  const auto refusal = [&](std::string problem) {
    return fileFault(recording, std::move(problem),
                     "try: wholehand report " + recording + " --out " + folder);
  };
  const auto ends = [this] { return ending_.load() || InterruptScope::interrupted(); };
  if (ends()) return refusal("no report is made: the program is ending");
  const ChildLimits limits{.time = longest_, .memory_bytes = kMemory_bytes, .idle_disk = true};
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

std::string Reports::folderOf(const std::string& recording, std::string& why) {
  const std::lock_guard lock(mutex_);
  std::string folder = recording.substr(0, recording.size() - 3) + "-report";
  const std::string identity = identityOf(recording);
  if (isReportOf(folder, identity)) return folder;
  if (!make_) {
    why = "this program makes no reports";
    return {};
  }
  std::error_code ignored;
  std::filesystem::remove(markIn(folder), ignored);
  if (auto made = make_(recording, folder); !made) {
    why = format(made.errors());
    return {};
  }
  // The page is not marked when the recording was replaced meanwhile; the next request makes it
  // again.
  if (identityOf(recording) == identity) (void)writeText(markIn(folder), identity);
  return folder;
}

}  // namespace wholehand
