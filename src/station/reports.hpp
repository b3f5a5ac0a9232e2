#pragma once

#include "loop/core/expected.hpp"

#include <atomic>
#include <chrono>
#include <string>

namespace wholehand {

/// Makes report pages in a child process: HDF5 may be writing in this process, a page takes seconds
/// of CPU time, and a malicious file may crash its reader. The child runs at the lowest CPU and
/// disk priority, within limits of time and memory, and never keeps this program from exiting. Any
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

/// Identity of a recording file: its device, inode, size and modification time. A recording that
/// replaces another one under the same name has a different identity. Empty when there is no such
/// file.
[[nodiscard]] std::string identityOf(const std::string& recording);

/// True when the folder holds the finished report of the recording with that identity.
[[nodiscard]] bool isReportOf(const std::string& folder, const std::string& identity);

/// Marks a report as finished. A report without a mark is made again on the next request.
void markReport(const std::string& folder, const std::string& identity);

/// Removes the mark of a report that is about to be made again.
void unmarkReport(const std::string& folder);

}  // namespace wholehand
