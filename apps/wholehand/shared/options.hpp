#pragma once

#include "assembly/engines.hpp"

#include <CLI/CLI.hpp>

#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <system_error>

namespace wholehand {

/// CLI11 validator that accepts only finite numbers of a range (CLI11's own accepts nan).
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

/// CLI11 validator that accepts only unsigned 64-bit integers (CLI11 itself converts -1, and larger
/// numbers, to the largest one).
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

/// Adds `--engine NAME` to a command that builds a world.
inline CLI::Option* addEngine(CLI::App& command, std::string& engine) {
  return command.add_option("--engine", engine, "Physics engine (docs/engines.md)")
      ->check(CLI::IsMember(engineNames()))
      ->capture_default_str();
}

}  // namespace wholehand
