#pragma once

#include <string_view>

namespace wholehand {

/// A command that the program wholehand-tools has.
struct ToolCommand {
  const char* name;
  const char* help;
};
/// Commands of wholehand-tools; `wholehand NAME ...` runs them.
inline constexpr ToolCommand kToolCommands[] = {
    {"device", "Real devices: their drivers and hosts"},
    {"certify",
     "Check that gains are stable with any passive person and object, and by what margin"},
    {"experiment", "Repeat the paper's experiments"},
    {"sweep", "Run every combination of a grid: gains, hands, patients"},
    {"decompose", "Divide a mesh into convex pieces for a scene"}};

/// Whether wholehand-tools has a command of this name.
[[nodiscard]] bool isToolCommand(std::string_view name);
/// Help of a command of kToolCommands.
[[nodiscard]] const char* toolHelp(std::string_view name);

/// Replaces this process by wholehand-tools, which stands beside this program. In a checkout a
/// missing program, or one of another version, is built first, unless a loop of this build runs:
/// nothing compiles beside a loop. Returns the exit code where it could not be started.
int runTool(int argc, char** argv);

}  // namespace wholehand
