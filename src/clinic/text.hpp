#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Text as a therapist types it and as a table shows it.
namespace wholehand::clinic {

/// Lower case of ASCII and of Latin letters with accents, for searching.
[[nodiscard]] std::string folded(std::string_view utf8);
/// True for at most `most` characters of UTF-8 without control characters (line feeds only where
/// allowed).
[[nodiscard]] bool isText(std::string_view utf8, std::size_t most, bool lines);
/// Microseconds of a day "1956-03-02" at 0:00 UTC; empty: no such day.
[[nodiscard]] std::optional<std::int64_t> dayOf(std::string_view iso);
/// Microseconds of "2026-11-28T04:22:37[.5]Z"; empty: no such time.
[[nodiscard]] std::optional<std::int64_t> timeOf(std::string_view iso);
/// "2026-11-28T04:22:37Z", and with an offset of local time "2026-11-28T05:22:37+01:00".
[[nodiscard]] std::string isoTime(std::int64_t at_us);
[[nodiscard]] std::string isoTime(std::int64_t at_us, int offset_min);
/// A cell of a CSV file: quoted where needed; a spreadsheet takes none for a formula.
[[nodiscard]] std::string csvCell(std::string_view text);
/// Levels of nesting of a JSON text, not parsed.
[[nodiscard]] std::size_t jsonDepth(std::string_view json);

}  // namespace wholehand::clinic
