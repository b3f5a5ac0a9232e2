#pragma once

#include "rig/engines.hpp"

#include <CLI/CLI.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <string>
#include <system_error>

namespace wholehand {

/// CLI11 validator that accepts only finite numbers in a range (CLI11's own validator accepts nan).
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

/// CLI11 validator that accepts only whole numbers in a range.
inline CLI::Validator wholeBetween(std::int64_t least, std::int64_t most) {
  return CLI::Validator(
      [least, most](std::string& text) -> std::string {
        std::int64_t value = 0;
        const char* end = text.data() + text.size();
        const auto [read_to, error] = std::from_chars(text.data(), end, value);
        if (error == std::errc{} && read_to == end && value >= least && value <= most) return {};
        return "'" + text + "' is not a whole number from " + std::to_string(least) + " to " +
               std::to_string(most);
      },
      "whole number from " + std::to_string(least) + " to " + std::to_string(most));
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

/// Adds `--rate-hz` of the loop.
inline CLI::Option* addRate(CLI::App& command, double& rate_hz) {
  return command.add_option("--rate-hz", rate_hz, "Ticks a second")
      ->check(finiteBetween(100.0, 16000.0, "Hz"))
      ->capture_default_str();
}

/// Adds `--hand`, `--device` and `--rendering`. Without --rendering, findGains() chooses the file.
inline std::array<CLI::Option*, 3> addHandAndDevice(CLI::App& command, std::string& hand,
                                                    std::string& device, std::string& rendering) {
  return {command.add_option("--hand", hand, "Hand file")->capture_default_str(),
          command.add_option("--device", device, "Device file")->capture_default_str(),
          command.add_option("--rendering", rendering,
                             "Gains that go with the device (default: the file of the device's "
                             "name)")};
}

/// Adds `--engine NAME` to a command that builds a world.
inline CLI::Option* addEngine(CLI::App& command, std::string& engine) {
  return command.add_option("--engine", engine, "Physics engine (docs/engines.md)")
      ->check(CLI::IsMember(engineNames()))
      ->capture_default_str();
}

}  // namespace wholehand
