#pragma once

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <system_error>

namespace wholehand {

/// A check for CLI11 that lets only finite numbers of a range pass (CLI11's own lets nan pass).
inline CLI::Validator finiteBetween(double low, double high, const std::string& unit) {
  const std::string range = "[" + CLI::detail::to_string(low) + ", " +
                            CLI::detail::to_string(high) + "]" + (unit.empty() ? "" : " " + unit);
  return CLI::Validator(
      [low, high, range](std::string& text) -> std::string {
        double value = 0.0;
        if (!CLI::detail::lexical_cast(text, value) || !std::isfinite(value) || value < low ||
            value > high) {
          return "'" + text + "' is not a number in " + range;
        }
        return {};
      },
      "number in " + range);
}

/// A check for CLI11 that lets only whole numbers of 64 bits pass (CLI11 itself turns -1 into the
/// largest one, and what is larger into that, too).
inline CLI::Validator wholeNumber() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        std::uint64_t value = 0;
        const char* end = text.data() + text.size();
        const auto [read_to, error] = std::from_chars(text.data(), end, value);
        if (error == std::errc{} && read_to == end) return {};
        return "'" + text + "' is not a whole number from 0 to 18446744073709551615";
      },
      "whole number");
}

}  // namespace wholehand
