#pragma once

#include "device/plugin/plugin_driver.hpp"
#include "pages.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace wholehand {

/// What `wholehand device commission` was asked for.
struct CommissionOptions {
  DriverLocation driver;  ///< no path: a host's
  std::string host;
  std::string device;  ///< file
  std::string operator_name;
  double rate_hz = 1000.0;
  bool daily = false;
  std::string record;  ///< file of the recording; empty: named by the time
  bool web = false;
  PageOptions pages;  ///< of --web
};

/// Leads through the commissioning of a device, in the terminal or at a page. Returns the program's
/// exit code.
int commissionCommand(const CommissionOptions& options);

/// `wholehand device commission`.
/// @param options outlives the parsing, as `code` does
void addCommission(CLI::App& app, CommissionOptions& options, int& code);

}  // namespace wholehand
