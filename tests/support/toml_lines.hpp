#pragma once

#include "loop/core/expected.hpp"
#include "support/seed.hpp"

#include <algorithm>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

namespace wholehand::test {

/// A line of a TOML file with a key and its whole value.
struct KeyLine {
  std::size_t line = 0;  ///< from 0
  std::string key, value;
};

inline std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

inline std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

inline std::vector<KeyLine> keyLines(const std::vector<std::string>& lines) {
  const std::regex key_line("^([a-z0-9_]+) *= *(.*)");
  std::vector<KeyLine> found;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (!std::regex_match(lines[i], match, key_line)) continue;
    const std::string value = match[2];
    if (std::count(value.begin(), value.end(), '[') ==
        std::count(value.begin(), value.end(), ']')) {
      found.push_back({i, match[1], value});
    }
  }
  return found;
}

/// Faulty versions of a key: another type, another name, and for a number an infinite and an
/// out-of-range value. All of them with WHOLEHAND_FULL=1, otherwise one at random.
inline std::vector<std::string> wrongLines(const KeyLine& good, std::mt19937_64& random) {
  std::vector<std::string> wrong = {good.key + "_x = 1"};
  for (const char* value : {"{ a = 1 }", "nan", "-inf", "-1e30", "1e30", "\"1\""}) {
    const bool number = good.value.find_first_of("-0123456789") == 0;
    if (wrong.size() < 3 || number) wrong.push_back(good.key + " = " + value);
  }
  return fullCounts() ? wrong : std::vector<std::string>{wrong[random() % wrong.size()]};
}

inline bool namesKey(const Diagnostics& faults, const std::string& key) {
  return std::any_of(faults.begin(), faults.end(),
                     [&](const Diagnostic& d) { return d.key.find(key) != std::string::npos; });
}

}  // namespace wholehand::test
