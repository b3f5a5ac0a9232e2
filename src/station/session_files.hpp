#pragma once

#include "server/backend.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// Current UTC time, ISO 8601, to the second.
[[nodiscard]] std::string utcNow();

/// The folder in which a station keeps its recordings. A small JSON file beside each holds what
/// lists show, so that listing opens no HDF5 file while another is being written.
class SessionFiles {
 public:
  /// @param folder created with the first recording; empty: no recordings are kept
  explicit SessionFiles(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] bool kept() const { return !folder_.empty(); }
  /// Path for a new recording: "<folder>/20261120-093812-p-014-cocktail-bar-level-1.h5". The time
  /// comes first, so that sorting by name sorts by time. Creates the folder; empty when that fails.
  /// @param person the loaded profile; empty: none
  [[nodiscard]] std::string nameNew(const std::string& person, const std::string& exercise,
                                    int level) const;
  /// Writes the JSON file of a finished recording; does nothing for one outside the folder.
  void note(const std::string& path, const std::string& title, const std::string& began_utc,
            double duration_s, std::uint64_t ticks_missing) const;
  /// Recordings, newest first. Those without a JSON file are described from their HDF5 file.
  /// @param being_written path of the recording in progress, which is listed wherever it is; empty:
  /// none
  [[nodiscard]] std::vector<RecordingEntry> list(const std::string& being_written) const;
  /// Path of a recording in the folder, or of the one in progress; empty for any other name.
  [[nodiscard]] std::string path(const std::string& name, const std::string& being_written) const;

 private:
  /// Path of the recording in progress if it is outside the folder and no recording in the folder
  /// has its name; else empty.
  [[nodiscard]] std::string outsidePath(const std::string& being_written) const;

  std::string folder_;
};

}  // namespace wholehand
