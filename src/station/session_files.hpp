#pragma once

#include "server/backend.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace wholehand {

/// ISO 8601, to the second.
[[nodiscard]] std::string utcNow();

/// The folder in which a station keeps its recordings. Beside each a small JSON file says what a
/// list shows of it, so that a list opens no HDF5 file while another is being written.
class SessionFiles {
 public:
  /// @param folder made when the first recording is; empty: nothing is kept
  explicit SessionFiles(std::string folder) : folder_(std::move(folder)) {}

  [[nodiscard]] bool kept() const { return !folder_.empty(); }
  /// A path for a new recording: "<folder>/20261120-093812-p-014-cocktail-bar-level-1.h5", time
  /// first, so that a list by name is one by time. Makes the folder; empty where it cannot.
  /// @param person the profile that is loaded; empty: none is
  [[nodiscard]] std::string nameNew(const std::string& person, const std::string& exercise,
                                    int level) const;
  /// Notes what a finished recording holds; nothing of one that lies elsewhere.
  void note(const std::string& path, const std::string& title, const std::string& began_utc,
            double duration_s, std::uint64_t ticks_missing) const;
  /// Newest first; those that nobody noted with what their file tells.
  /// @param being_written path of the recording that is being written, which is listed wherever it
  /// lies; empty: none
  [[nodiscard]] std::vector<RecordingEntry> list(const std::string& being_written) const;
  /// Path of a recording in the folder, or of the one that is being written; empty for any name
  /// that is none.
  [[nodiscard]] std::string path(const std::string& name, const std::string& being_written) const;

 private:
  /// Where it lies outside the folder; empty where it does not, or where one in the folder has its
  /// name.
  [[nodiscard]] std::string outsidePath(const std::string& being_written) const;

  std::string folder_;
};

}  // namespace wholehand
