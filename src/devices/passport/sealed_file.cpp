#include "devices/passport/sealed_file.hpp"

#include "files/toml/toml_file.hpp"
#include "loop/core/sha256.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

namespace wholehand {
namespace {

constexpr std::string_view kSeal = "[seal]\nsha256 = \"";
constexpr std::string_view kEnd = "\"\n";
constexpr std::size_t kDigits = 64;

}  // namespace

std::chrono::local_days PlaceTime::day() const {
  return std::chrono::floor<std::chrono::days>(
      std::chrono::local_seconds((at + ahead).time_since_epoch()));
}

PlaceTime placeTimeNow() {
  using namespace std::chrono;
  const auto now = floor<seconds>(system_clock::now());
  const std::time_t counted = system_clock::to_time_t(now);
  std::tm wall{};
  ::localtime_r(&counted, &wall);
  return {now, floor<minutes>(seconds(wall.tm_gmtoff))};
}

std::string format(std::chrono::local_days day) {
  const std::chrono::year_month_day date(day);
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

std::string format(const PlaceTime& time) {
  const auto wall = std::chrono::local_seconds((time.at + time.ahead).time_since_epoch());
  const std::chrono::hh_mm_ss clock(wall - time.day());
  const auto minutes = std::abs(time.ahead.count());
  return fmt::format("{}T{:02}:{:02}:{:02}{}{:02}:{:02}", format(time.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count(),
                     time.ahead.count() < 0 ? '-' : '+', minutes / 60, minutes % 60);
}

PlaceTime readTime(TomlTable& table, std::string_view key) {
  using namespace std::chrono;
  const std::string text = table.text(key);
  int year_number = 0;
  unsigned month_number = 0, day_number = 0;
  std::array<int, 5> clock{};  // hours, minutes, seconds; hours and minutes of the offset
  char sign = 0, rest = 0;
  const int read =
      std::sscanf(text.c_str(), "%4d-%2u-%2uT%2d:%2d:%2d%c%2d:%2d%c", &year_number, &month_number,
                  &day_number, &clock[0], &clock[1], &clock[2], &sign, &clock[3], &clock[4], &rest);
  const year_month_day date{year(year_number), month(month_number), day(day_number)};
  const auto within = [&](std::size_t i, int most) { return clock[i] >= 0 && clock[i] <= most; };
  if (read == 9 && date.ok() && (sign == '+' || sign == '-') && within(0, 23) && within(1, 59) &&
      within(2, 60) && within(3, 14) && within(4, 59)) {
    const minutes ahead = (hours(clock[3]) + minutes(clock[4])) * (sign == '-' ? -1 : 1);
    const sys_seconds wall =
        sys_days(date) + hours(clock[0]) + minutes(clock[1]) + seconds(clock[2]);
    return {wall - ahead, ahead};
  }
  if (table.isGood(key)) table.fail(key, "is no moment", "write it as 2026-11-21T09:30:00-08:00");
  return {};
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20U || byte == 0x7FU) continue;
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

std::string besideDeviceFile(const std::string& device_file, const std::string& serial,
                             const std::string& what) {
  std::string part = serial;
  std::replace_if(
      part.begin(), part.end(),
      [](unsigned char c) { return std::isalnum(c) == 0 && c != '-' && c != '_'; }, '-');
  const std::filesystem::path path(device_file);
  return (path.parent_path() / fmt::format("{}.{}.{}.toml", path.stem().string(), part, what))
      .string();
}

std::string seal(const std::string& text) {
  return text + std::string(kSeal) + sha256(text) + std::string(kEnd);
}

Expected<std::string> readWhole(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return fileFault(path, std::strerror(errno), "name a file that can be read");
  return std::string(std::istreambuf_iterator<char>(in), {});
}

Expected<std::string> checkSeal(const std::string& path, const std::string& remedy) {
  const Expected<std::string> text = readWhole(path);
  if (!text) return text.errors();
  const std::size_t at = text->rfind(kSeal);
  const std::size_t length = kSeal.size() + kDigits + kEnd.size();
  if (at == std::string::npos || text->size() < at + length) {
    return Diagnostic{path, 0, "seal", "", "is missing: the file is truncated", remedy};
  }
  const std::string stated = text->substr(at + kSeal.size(), kDigits);
  if (text->size() != at + length || stated != sha256(text->substr(0, at))) {
    return keyFault(path, "seal.sha256", "", "the file was changed after it was written", remedy);
  }
  return stated;
}

}  // namespace wholehand
