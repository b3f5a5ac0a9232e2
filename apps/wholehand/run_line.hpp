#pragma once

#include "run_options.hpp"

#include <CLI/CLI.hpp>

namespace wholehand {

/// Default options of `wholehand run`: the shipped files.
[[nodiscard]] RunOptions shippedRun();

/// Adds `wholehand run` with all its options.
/// @param options initialised by shippedRun(); outlives the parsing, like `code`
/// @param code exit code of the run
void addRun(CLI::App& app, RunOptions& options, int& code);

}  // namespace wholehand
