#pragma once

#include "loop/core/expected.hpp"

#include <atomic>
#include <chrono>
#include <string>

namespace wholehand {

/// Makes report pages in a child process: HDF5 may be writing in this one, a page takes seconds of
/// CPU time, and a malicious file may crash its reader. The child runs at the lowest CPU and disk
/// priority, within limits of time and memory, and never keeps this program from exiting. Any
/// thread.
class ReportChild {
 public:
  /// @param program run as `program report RECORDING --out FOLDER`; empty: this program
  explicit ReportChild(std::string program = {},
                       std::chrono::milliseconds longest = std::chrono::minutes(2))
      : program_(std::move(program)), longest_(longest) {}

  /// Waits for the page, or until the time limit, end() or Ctrl-C ends the child.
  [[nodiscard]] Expected<Done> make(const std::string& recording, const std::string& folder);
  /// Ends the running children; no new one is started.
  void end() noexcept { ending_.store(true); }

 private:
  const std::string program_;
  const std::chrono::milliseconds longest_;
  std::atomic<bool> ending_{false};
};

/// Of which file a report is. A recording that takes the name of another one has another identity:
/// its device, inode, size and time of its last change. Empty when there is no such file.
[[nodiscard]] std::string identityOf(const std::string& recording);

/// Whether a folder holds the finished report of the file with that identity.
[[nodiscard]] bool isReportOf(const std::string& folder, const std::string& identity);

/// Marks a finished report. Without a mark it is made again when it is asked for.
void markReport(const std::string& folder, const std::string& identity);

/// Removes the mark of a report that is made again.
void unmarkReport(const std::string& folder);

}  // namespace wholehand
