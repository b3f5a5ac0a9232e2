#pragma once

#include "loop/core/expected.hpp"
#include "vocabulary/backend.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace wholehand {

/// Makes a part of a file name that every file system accepts: letters (of any script), digits and
/// _ stay, each run of other characters becomes one -, and at most `most_bytes` bytes of whole
/// characters are kept. Empty when no character of the text can stay.
[[nodiscard]] std::string fileNamePart(std::string_view text, std::size_t most_bytes = 60);

/// Current UTC time, ISO 8601, to the second.
[[nodiscard]] std::string utcNow();

/// The folder in which a station keeps its recordings. A small JSON file next to each recording
/// holds the data shown in lists, so that listing opens no HDF5 file while another is being
/// written.
class SessionFiles {
 public:
  using WallClock = std::function<std::chrono::system_clock::time_point()>;

  /// @param folder created with the first recording; empty: no recordings are kept
  explicit SessionFiles(std::string folder, WallClock now = std::chrono::system_clock::now)
      : folder_(std::move(folder)), now_(std::move(now)) {}

  [[nodiscard]] bool kept() const { return !folder_.empty(); }
  /// Reserves the name of a new recording by creating an empty file, and the folder if needed:
  /// "<folder>/20261120-093812-p-014-cocktail-bar-level-1.h5". The time comes first, so that
  /// sorting by name sorts by time. No other program can get the name, whatever its clock says.
  /// @param person the loaded profile; empty: none
  [[nodiscard]] Expected<std::string> nameNew(const std::string& person,
                                              const std::string& exercise, int level) const;
  /// Removes the empty file of a reserved name that no recording has filled.
  void giveBack(const std::string& path) const;
  /// Removes a finished recording of this folder, with all its parts.
  void remove(const std::string& path) const;
  /// Writes the JSON file of a finished recording; does nothing for one outside the folder.
  void note(const std::string& path, const std::string& title, const std::string& person,
            const std::string& began_utc, double duration_s, std::uint64_t ticks_missing) const;
  /// Lists recordings, newest first. Recordings without a JSON file are described from their HDF5
  /// file.
  /// @param being_written path of the recording in progress, which is listed even outside the
  /// folder; empty: none
  [[nodiscard]] std::vector<RecordingEntry> list(const std::string& being_written) const;
  /// Path of a recording in the folder, or of the one in progress; empty for any other name.
  [[nodiscard]] std::string path(const std::string& name, const std::string& being_written) const;

 private:
  /// Path of the recording in progress if it is outside the folder and no recording in the folder
  /// has its name; else empty.
  [[nodiscard]] std::string outsidePath(const std::string& being_written) const;

  [[nodiscard]] bool isInside(const std::string& path) const;

  std::string folder_;
  WallClock now_;
};

/// Recording path of the session with this number, when `path` is that of the first session:
/// "a.h5", "a-2.h5", "a-3.h5".
[[nodiscard]] std::string pathOfSession(const std::string& path, std::uint64_t number);

}  // namespace wholehand
