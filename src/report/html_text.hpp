#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace wholehand {

/// "−3.25": fixed decimals, a true minus sign, never "−0"; "–" when not finite.
[[nodiscard]] std::string formatNumber(double value, int decimals);
/// "2.5 s", "20 ms", "3.1 µrad": two or three digits with the prefix that suits the size.
[[nodiscard]] std::string formatShort(double value, const std::string& unit);
/// "100,000"
[[nodiscard]] std::string formatCount(std::uint64_t value);
/// "12.3 s" under a minute, else "2:41".
[[nodiscard]] std::string formatDuration(double seconds);
/// "20 Nov 2026, 09:38 UTC" from "2026-11-20T09:38:00Z"; any other text as it stands.
[[nodiscard]] std::string formatDate(const std::string& iso_utc);

/// Base 64, RFC 4648.
[[nodiscard]] std::string encodeBase64(std::string_view bytes);

}  // namespace wholehand
