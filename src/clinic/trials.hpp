#pragma once

#include "clinic/records.hpp"
#include "clinic/station_client.hpp"
#include "loop/core/expected.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

namespace wholehand::clinic {

/// Measures one recording. Returns the JSON of `wholehand measures`, or empty with the reason.
using Measure = std::function<std::optional<Json>(const std::string& path, std::string& why)>;

/// Index of the recordings; compares the folder with the table.
class Trials {
 public:
  /// @param mutex guards the records; not held while a recording is measured
  Trials(Records& records, const Station& station, std::mutex& mutex)
      : records_(records), station_(station), mutex_(mutex) {}

  /// Implements Clinic::lookAtRecordings().
  void look(const Measure& measure, const std::function<bool()>& stop);

 private:
  struct FileState {
    std::int64_t size = 0, modified_ns = 0;
    std::int64_t due_us = 0;  ///< steady clock; it is not measured earlier
    int failed = 0;           ///< failed attempts with its present content
    bool known = false;       ///< the database knows its present content
  };
  void store(const std::string& name, const FileState& file, const std::optional<Json>& json,
             const std::string& why);
  void noteMissing(std::set<std::string> present);

  Records& records_;
  const Station& station_;
  std::mutex& mutex_;
  std::map<std::string, FileState> files_;
  std::set<std::string> present_;  ///< recordings found by the last call, and the one in progress
};

/// Measures in a child process `PROGRAM measures FILE`, at the lowest priority, for at most 120 s.
/// @param stop ends the child early; any thread
[[nodiscard]] Measure measureByChild(std::string program, std::function<bool()> stop);

/// Measures all recordings of the folder again. Visits do not change, nor do the results of
/// recordings that are gone.
/// @return result in one sentence
[[nodiscard]] Expected<std::string> rebuildTrials(const std::string& folder,
                                                  const std::string& recordings,
                                                  const Measure& measure);

}  // namespace wholehand::clinic
