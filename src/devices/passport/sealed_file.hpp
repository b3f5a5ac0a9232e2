#pragma once

#include "loop/core/expected.hpp"

#include <chrono>
#include <string>
#include <string_view>

namespace wholehand {
class TomlTable;
}

/// Files that commissioning writes next to a device file. Not real-time safe.
namespace wholehand {

/// A moment, with the local time at the place.
struct PlaceTime {
  std::chrono::sys_seconds at{};  ///< UTC
  std::chrono::minutes ahead{};   ///< offset of local time from UTC [min]: -720 to 840
  /// Local day at the place.
  [[nodiscard]] std::chrono::local_days day() const;
};
/// Present time by this machine's clock and time zone.
[[nodiscard]] PlaceTime placeTimeNow();
/// Formats as "2026-11-21".
[[nodiscard]] std::string format(std::chrono::local_days day);
/// Formats as "2026-11-21T09:30:00-08:00".
[[nodiscard]] std::string format(const PlaceTime& time);
/// Reads the moment at a key. Reports a value that is not a moment as a fault of the file.
[[nodiscard]] PlaceTime readTime(TomlTable& table, std::string_view key);

/// A text as a quoted TOML string, without control characters.
[[nodiscard]] std::string quoted(const std::string& text);

/// Path next to a device file: mine.toml, serial S-1, "passport" give mine.S-1.passport.toml.
/// Characters unfit for a file name become dashes.
[[nodiscard]] std::string besideDeviceFile(const std::string& device_file,
                                           const std::string& serial, const std::string& what);

/// Appends a table `[seal]` with the SHA-256 of all text before it. It detects accidents and
/// careless edits; it is not a signature.
[[nodiscard]] std::string seal(const std::string& text);

/// Reads the bytes of a file. Refused: a file that cannot be read.
[[nodiscard]] Expected<std::string> readWhole(const std::string& path);

/// Checks the seal of a file and returns its digest. Refused: a file that cannot be read, that ends
/// before its seal (truncated), or that was changed.
/// @param remedy instruction to make a new file
[[nodiscard]] Expected<std::string> checkSeal(const std::string& path, const std::string& remedy);

}  // namespace wholehand
