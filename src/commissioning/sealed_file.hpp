#pragma once

#include "core/expected.hpp"
#include "model/toml/toml_file.hpp"

#include <chrono>
#include <string>
#include <string_view>

/// Files that commissioning writes beside a device file. Not for the tick.
namespace wholehand {

/// A day in UTC.
using Day = std::chrono::sys_days;
[[nodiscard]] Day today();
/// "2026-11-21"
[[nodiscard]] std::string format(Day day);
/// The day at a key; what is no date is reported to the file.
[[nodiscard]] Day readDay(TomlTable& table, std::string_view key);

/// A text as a TOML file has it, without control characters.
[[nodiscard]] std::string quoted(const std::string& text);

/// mine.toml, serial S-1, "passport": mine.S-1.passport.toml in the same folder. What a file's name
/// should not hold becomes a dash.
[[nodiscard]] std::string besideDeviceFile(const std::string& device_file,
                                           const std::string& serial, const std::string& what);

/// A TOML text whose last table, `[seal]`, holds the SHA-256 of all before it. It tells accidents
/// and careless edits; it is no signature.
[[nodiscard]] std::string seal(const std::string& text);

/// The bytes of a file. Refused: a file that cannot be read.
[[nodiscard]] Expected<std::string> readWhole(const std::string& path);

/// Whether a sealed file is as it was written; its digest. Refused: one that cannot be read, one
/// that ends before its seal (truncated), one that was changed.
/// @param remedy what makes a new one
[[nodiscard]] Expected<std::string> checkSeal(const std::string& path, const std::string& remedy);

}  // namespace wholehand
