#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// Text and times in the forms that therapists type and tables show.
namespace wholehand::clinic {

inline constexpr std::int64_t kSecond_us = 1'000'000, kDay_us = 86'400 * kSecond_us;

/// Wall clock, which may be set back, and a monotonic clock. Any thread.
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual std::int64_t now_us() const = 0;     ///< UTC since 1970 [µs]
  [[nodiscard]] virtual std::int64_t steady_us() const = 0;  ///< monotonic, since an arbitrary
                                                             ///< moment [µs]
  /// Monotonic, counts also while the machine sleeps [µs].
  [[nodiscard]] virtual std::int64_t boot_us() const { return steady_us(); }
  /// Local time minus UTC at a moment [min].
  [[nodiscard]] virtual int offset_min(std::int64_t at_us) const = 0;
};

/// The system's clocks.
class SystemClock final : public Clock {
 public:
  [[nodiscard]] std::int64_t now_us() const override;
  [[nodiscard]] std::int64_t steady_us() const override;
  [[nodiscard]] std::int64_t boot_us() const override;
  [[nodiscard]] int offset_min(std::int64_t at_us) const override;
};

/// Lower case of ASCII letters and of Latin letters with accents, for searching.
[[nodiscard]] std::string folded(std::string_view utf8);
/// True for UTF-8 text of at most `most` characters without control characters. Line feeds are
/// allowed if `lines` is true.
[[nodiscard]] bool isText(std::string_view utf8, std::size_t most, bool lines);
/// Microseconds of a day "1956-03-02" at 0:00 UTC; empty: no such day.
[[nodiscard]] std::optional<std::int64_t> dayOf(std::string_view iso);
/// Microseconds of "2026-11-28T04:22:37[.5]Z"; empty: no such time.
[[nodiscard]] std::optional<std::int64_t> timeOf(std::string_view iso);
/// "2026-11-28T04:22:37Z", and with an offset of local time "2026-11-28T05:22:37+01:00".
[[nodiscard]] std::string isoTime(std::int64_t at_us);
[[nodiscard]] std::string isoTime(std::int64_t at_us, int offset_min);
/// A cell of a CSV file, quoted where needed, so that a spreadsheet does not take it for a formula.
[[nodiscard]] std::string csvCell(std::string_view text);
/// Nesting depth of a JSON text, without parsing it.
[[nodiscard]] std::size_t jsonDepth(std::string_view json);

}  // namespace wholehand::clinic
