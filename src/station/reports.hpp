#pragma once

#include "loop/core/expected.hpp"

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <string>
#include <utility>

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

/// Report pages of recordings, each made at its first request. A recording that replaces another
/// one under the same name gets a page of its own. Any thread.
class Reports {
 public:
  using Make =
      std::function<Expected<Done>(const std::string& recording, const std::string& folder)>;

  /// @param make makes a page; null: none can be made
  explicit Reports(Make make) : make_(std::move(make)) {}

  /// Folder of the page of a finished recording; empty: none, and why says the reason.
  [[nodiscard]] std::string folderOf(const std::string& recording, std::string& why);

 private:
  Make make_;
  std::mutex mutex_;  ///< held while a page is made: two concurrent requests share one
};

}  // namespace wholehand
