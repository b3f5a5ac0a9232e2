#pragma once

#include "run_options.hpp"

#include <CLI/CLI.hpp>

namespace wholehand {

/// What `wholehand run` does when it is told nothing: the shipped files.
[[nodiscard]] RunOptions shippedRun();

/// `wholehand run` and all that it may be told on the command line.
/// @param options as shippedRun() has them; outlives the parsing, as `code` does
/// @param code the program's exit code, once it has run
void addRun(CLI::App& app, RunOptions& options, int& code);

}  // namespace wholehand
