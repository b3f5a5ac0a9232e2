#pragma once

#include "core/expected.hpp"

#include <atomic>
#include <chrono>
#include <string>

namespace wholehand {

/// Makes report pages in a process of its own: HDF5 may be writing in this one, and a page takes
/// seconds of a core, and a stranger's file may end its reader. That process runs at the lowest
/// priority of CPU and disk, within limits of time and memory, and never keeps this program from
/// ending. Any thread.
class ReportChild {
 public:
  /// @param program that is run as `program report RECORDING --out FOLDER`; empty: this one
  explicit ReportChild(std::string program = {},
                       std::chrono::milliseconds longest = std::chrono::minutes(2))
      : program_(std::move(program)), longest_(longest) {}

  /// Waits for the page, or for what ends its making: the time limit, end(), Ctrl-C.
  [[nodiscard]] Expected<Done> make(const std::string& recording, const std::string& folder);
  /// Ends the processes under way; none is begun any more.
  void end() noexcept { ending_.store(true); }

 private:
  const std::string program_;
  const std::chrono::milliseconds longest_;
  std::atomic<bool> ending_{false};
};

}  // namespace wholehand
