#include "clinic/text.hpp"

#include "loop/core/printable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <ctime>

namespace wholehand::clinic {
namespace {

std::optional<int> digits(std::string_view text, std::size_t at, std::size_t count) {
  if (at + count > text.size()) return {};
  int value = 0;
  const char* end = text.data() + at + count;
  const auto read = std::from_chars(text.data() + at, end, value);
  if (read.ec != std::errc{} || read.ptr != end || value < 0) return {};
  return value;
}

}  // namespace

std::int64_t SystemClock::now_us() const {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}
std::int64_t SystemClock::steady_us() const {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}
std::int64_t SystemClock::boot_us() const {
  std::timespec time{};
  ::clock_gettime(CLOCK_BOOTTIME, &time);
  return time.tv_sec * kSecond_us + time.tv_nsec / 1000;
}
int SystemClock::offset_min(std::int64_t at_us) const {
  const std::time_t at_s = at_us / kSecond_us;
  std::tm local{};
  return localtime_r(&at_s, &local) == nullptr ? 0 : static_cast<int>(local.tm_gmtoff / 60);
}

std::string folded(std::string_view utf8) {
  std::string out(utf8);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto c = static_cast<unsigned char>(out[i]);
    if (c >= 'A' && c <= 'Z') out[i] = static_cast<char>(c + 32);
    // Letters U+00C0 to U+00DE, without the multiplication sign U+00D7.
    const bool accented = i > 0 && static_cast<unsigned char>(out[i - 1]) == 0xC3U;
    if (accented && c >= 0x80U && c <= 0x9EU && c != 0x97U) out[i] = static_cast<char>(c + 32);
  }
  return out;
}

bool isText(std::string_view utf8, std::size_t most, bool lines) {
  std::string one_line(utf8);
  if (lines) std::replace(one_line.begin(), one_line.end(), '\n', ' ');
  return isPrintable(one_line, most);
}

std::optional<std::int64_t> dayOf(std::string_view iso) {
  if (iso.size() != 10 || iso[4] != '-' || iso[7] != '-') return {};
  const auto year = digits(iso, 0, 4), month = digits(iso, 5, 2), day = digits(iso, 8, 2);
  if (!year || !month || !day) return {};
  const std::chrono::year_month_day date{std::chrono::year(*year),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return {};
  return std::chrono::sys_days(date).time_since_epoch().count() * kDay_us;
}

std::optional<std::int64_t> timeOf(std::string_view iso) {
  if (iso.size() < 19 || (iso[10] != 'T' && iso[10] != ' ')) return {};
  const auto day_us = dayOf(iso.substr(0, 10));
  const auto hour = digits(iso, 11, 2), minute = digits(iso, 14, 2), second = digits(iso, 17, 2);
  if (!day_us || !hour || !minute || !second) return {};
  std::int64_t part_us = 0, unit_us = kSecond_us;
  if (iso.size() > 19 && iso[19] == '.') {
    for (std::size_t i = 20; i < iso.size() && iso[i] >= '0' && iso[i] <= '9'; ++i) {
      part_us += (iso[i] - '0') * (unit_us /= 10);
    }
  }
  return *day_us + ((*hour * 60 + *minute) * 60 + *second) * kSecond_us + part_us;
}

std::string isoTime(std::int64_t at_us) {
  const std::time_t at_s = at_us / kSecond_us;
  std::tm utc{};
  if (gmtime_r(&at_s, &utc) == nullptr) return {};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", utc.tm_year + 1900, utc.tm_mon + 1,
                     utc.tm_mday, utc.tm_hour, utc.tm_min, utc.tm_sec);
}

std::string isoTime(std::int64_t at_us, int offset_min) {
  std::string out = isoTime(at_us + offset_min * std::int64_t{60} * kSecond_us);
  out.pop_back();
  const int magnitude = std::abs(offset_min);
  return out +
         fmt::format("{}{:02}:{:02}", offset_min < 0 ? '-' : '+', magnitude / 60, magnitude % 60);
}

std::string csvCell(std::string_view text) {
  std::string out;
  if (!text.empty() && std::string_view("=+-@\t\r").find(text[0]) != std::string_view::npos) {
    out = "'";
  }
  out += text;
  if (out.find_first_of(",\"\n\r") == std::string::npos) return out;
  std::string quoted = "\"";
  for (const char c : out) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::size_t jsonDepth(std::string_view json) {
  std::size_t depth = 0, most = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      most = std::max(most, ++depth);
    } else if ((c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return most;
}

}  // namespace wholehand::clinic
