#pragma once

#include "apps/wholehand/shared/pages.hpp"
#include "devices/plugin/plugin_driver.hpp"

#include <CLI/CLI.hpp>

#include <string>

namespace wholehand {

/// Options of `wholehand device commission`.
struct CommissionOptions {
  DriverLocation driver;  ///< empty path: the driver of a host
  std::string host;
  bool simulated = false;  ///< use a simulated plant of the device file
  std::string device;      ///< device file
  std::string operator_name;
  double rate_hz = 1000.0;
  bool daily = false;
  std::string record;  ///< file of the recording; empty: named after the time
  bool web = false;
  std::string token_file;  ///< token file of --web; empty: none
  PageOptions pages;       ///< options of --web
};

/// Guides the commissioning of a device, in the terminal or at a page. Returns the exit code.
int commissionCommand(const CommissionOptions& options);

/// Adds `wholehand device commission`.
/// @param options outlives the parsing, as does `code`
void addCommission(CLI::App& app, CommissionOptions& options, int& code);

}  // namespace wholehand
