#pragma once

#include <CLI/CLI.hpp>

namespace wholehand {

/// Main function of a program: limits the stacks of later threads, ignores SIGPIPE, runs `program`,
/// flushes standard output and reports exceptions. Returns the exit code.
int runMain(int argc, char** argv, int (*program)(int argc, char** argv));

/// Parses a command line and runs its subcommand. Hides tokens in the process list first.
/// @param code set by the subcommand
/// @return `code`; or, after help or a message about the command line, the code of that
int parseCommandLine(CLI::App& app, int argc, char** argv, const int& code);

}  // namespace wholehand
