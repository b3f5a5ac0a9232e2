#include "commissioning/sealed_file.hpp"

#include "core/sha256.hpp"
#include "model/toml/toml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
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

Day today() {
  return std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
}

std::string format(Day day) {
  const std::chrono::year_month_day date(day);
  return fmt::format("{:04}-{:02}-{:02}", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()));
}

Day readDay(TomlTable& table, std::string_view key) {
  const std::string text = table.text(key);
  int year = 0;
  unsigned month = 0, day = 0;
  char rest = 0;
  const int read = std::sscanf(text.c_str(), "%4d-%2u-%2u%c", &year, &month, &day, &rest);
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(month),
                                         std::chrono::day(day)};
  if (read == 3 && date.ok()) return Day(date);
  if (table.isGood(key)) table.fail(key, "is no date", "write it as 2026-11-21");
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
  if (!in) return Diagnostic{path, 0, "", "", std::strerror(errno), "name a file that can be read"};
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
    return Diagnostic{path,  0, "seal.sha256", "", "the file was changed after it was written",
                      remedy};
  }
  return stated;
}

}  // namespace wholehand
