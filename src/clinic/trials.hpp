#pragma once

#include "clinic/records.hpp"
#include "clinic/station.hpp"
#include "loop/core/expected.hpp"

#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

namespace wholehand::clinic {

/// Measures one recording: the JSON of `wholehand measures`, or empty with the reason.
using Measure = std::function<std::optional<Json>(const std::string& path, std::string& why)>;

/// The index of the recordings, made by comparing folder and table.
class Trials {
 public:
  /// @param mutex guards the records, and is not held while a recording is measured
  Trials(Records& records, const Station& station, std::mutex& mutex)
      : records_(records), station_(station), mutex_(mutex) {}

  /// As Clinic::lookAtRecordings().
  void look(const Measure& measure, const std::function<bool()>& stop);

 private:
  struct SeenFile {
    std::int64_t size = 0, modified_ns = 0;
    std::int64_t due_us = 0;  ///< steady clock: it is measured from then on
    int failed = 0;           ///< times, as it is
    bool known = false;       ///< the database has it as it is
  };
  void store(const std::string& name, const SeenFile& file, const std::optional<Json>& json,
             const std::string& why);
  void noteMissing(std::set<std::string> present);

  Records& records_;
  const Station& station_;
  std::mutex& mutex_;
  std::map<std::string, SeenFile> files_;
  std::set<std::string> present_;  ///< recordings of the last look, and the one being written
};

/// Measures by the child `PROGRAM measures FILE`, at the lowest priority, 120 s at most.
/// @param stop ends the child early; any thread
[[nodiscard]] Measure measureByChild(std::string program, std::function<bool()> stop);

/// Measures the folder's recordings again. Visits stay as they are, and so do the results of
/// recordings that are gone.
/// @return what was found, one sentence
[[nodiscard]] Expected<std::string> rebuildTrials(const std::string& folder,
                                                  const std::string& recordings,
                                                  const Measure& measure);

}  // namespace wholehand::clinic
