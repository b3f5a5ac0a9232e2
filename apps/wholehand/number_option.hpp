#pragma once

#include <CLI/CLI.hpp>

#include <cmath>
#include <string>

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

}  // namespace wholehand
