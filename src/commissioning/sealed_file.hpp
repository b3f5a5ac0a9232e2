#pragma once

#include "core/expected.hpp"

#include <chrono>
#include <string>
#include <string_view>

namespace wholehand {
class TomlTable;
}

/// Files that commissioning writes beside a device file. Not real-time safe.
namespace wholehand {

/// A day in UTC.
using Day = std::chrono::sys_days;
[[nodiscard]] Day today();
/// "2026-11-21"
[[nodiscard]] std::string format(Day day);
/// The day at a key. Reports to the file a value that is no date.
[[nodiscard]] Day readDay(TomlTable& table, std::string_view key);

/// A text as a quoted TOML string, without control characters.
[[nodiscard]] std::string quoted(const std::string& text);

/// Path beside a device file: mine.toml, serial S-1, "passport" give mine.S-1.passport.toml.
/// Characters unfit for a file name become dashes.
[[nodiscard]] std::string besideDeviceFile(const std::string& device_file,
                                           const std::string& serial, const std::string& what);

/// Appends a table `[seal]` with the SHA-256 of all text before it. It detects accidents and
/// careless edits; it is not a signature.
[[nodiscard]] std::string seal(const std::string& text);

/// Bytes of a file. Refused: a file that cannot be read.
[[nodiscard]] Expected<std::string> readWhole(const std::string& path);

/// Verifies the seal of a file and returns its digest. Refused: a file that cannot be read, that
/// ends before its seal (truncated), or that was changed.
/// @param remedy how a new file is made
[[nodiscard]] Expected<std::string> checkSeal(const std::string& path, const std::string& remedy);

}  // namespace wholehand
