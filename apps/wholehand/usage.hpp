#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace wholehand {

/// Prints what is wrong with a command line, or the help that was asked for, with the words of
/// others as plain text. `words` are those of the command line. Returns the exit code.
int tellUsage(const CLI::App& app, const CLI::ParseError& error,
              const std::vector<std::string>& words);

}  // namespace wholehand
