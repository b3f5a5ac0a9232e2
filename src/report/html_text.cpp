#include "report/html_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace wholehand {

std::string formatNumber(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, std::abs(value));
  const std::string digits = text.data();
  const bool zero = digits.find_first_not_of("0.") == std::string::npos;
  return value < 0.0 && !zero ? std::string("−").append(digits) : digits;
}

std::string formatShort(double value, const std::string& unit) {
  static constexpr std::array<const char*, 4> kPrefixes = {"", "m", "µ", "n"};
  std::size_t prefix = 0;
  // Below 0.095 the next prefix gives two digits; what is smaller than all of them is nothing.
  while (std::abs(value) < 0.095 && value != 0.0 && prefix + 1 < kPrefixes.size()) {
    value *= 1000.0;
    ++prefix;
  }
  return formatNumber(value, std::abs(value) < 9.95 ? 1 : 0) + " " + kPrefixes[prefix] + unit;
}

std::string formatCount(std::uint64_t value) {
  const std::string digits = std::to_string(value);
  std::string out;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) out += ',';
    out += digits[i];
  }
  return out;
}

std::string formatDuration(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  if (seconds < 59.95) return formatNumber(seconds, 1) + " s";
  const auto whole = static_cast<long long>(std::llround(seconds));
  const std::string rest = std::to_string(whole % 60);
  return std::to_string(whole / 60) + ":" + (rest.size() < 2 ? "0" : "") + rest;
}

std::string formatDate(const std::string& iso_utc) {
  static constexpr std::array<const char*, 12> kMonths = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                          "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  int year = 0, month = 0, day = 0, hour = 0, minute = 0;
  if (std::sscanf(iso_utc.c_str(), "%4d-%2d-%2dT%2d:%2d", &year, &month, &day, &hour, &minute) !=
          5 ||
      month < 1 || month > 12) {
    return iso_utc;
  }
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%d %s %d, %02d:%02d UTC", day,
                kMonths[static_cast<std::size_t>(month - 1)], year, hour, minute);
  return text.data();
}

std::string encodeBase64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8U | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      const bool used = i + k <= bytes.size();  // k digits need k bytes, rounded up
      out += used ? kDigits[group >> (18U - 6U * static_cast<unsigned>(k)) & 63U] : '=';
    }
  }
  return out;
}

}  // namespace wholehand
