#include "apps/wholehand/shared/tools.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "files/process/child_process.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/printable.hpp"
#include "rig/program_version.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

namespace wholehand {
namespace {

namespace fs = std::filesystem;
using std::chrono_literals::operator""s;
using std::chrono_literals::operator""min;

constexpr const char* kProgram = "wholehand-tools";

fs::path thisProgram() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error);
}

/// "wholehand 0.1.0 (abc)" as a program prints it; empty where it cannot run.
std::string versionOf(const fs::path& program) {
  ChildLimits limits;
  limits.time = 10s;
  limits.output_bytes = 1000;
  const ChildResult child = runChild(program.string(), {"--version"}, limits);
  if (child.ending != ChildEnding::kExited || child.code != 0) return {};
  return child.output.substr(0, child.output.find('\n'));
}

/// Root of the checkout that a build folder belongs to; empty: none.
fs::path checkoutOf(const fs::path& folder) {
  constexpr std::string_view kKey = "CMAKE_HOME_DIRECTORY:INTERNAL=";
  std::ifstream cache(folder / "CMakeCache.txt");
  for (std::string line; std::getline(cache, line);) {
    if (line.starts_with(kKey)) return line.substr(kKey.size());
  }
  return {};
}

/// A process that runs a loop of this build; empty: none.
std::optional<int> findLoop(const fs::path& program) {
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename().string();
    int process = 0;
    if (std::from_chars(name.data(), name.data() + name.size(), process).ec != std::errc{})
      continue;
    std::error_code gone;
    if (fs::read_symlink(entry.path() / "exe", gone) != program) continue;
    std::ifstream file(entry.path() / "cmdline", std::ios::binary);
    std::string command;
    std::getline(file, command, '\0');
    std::getline(file, command, '\0');
    if (command == "run" || command == "device-host") return process;
  }
  return std::nullopt;
}

/// Builds the program in a checkout; the script shows its progress.
Expected<Done> build(const fs::path& checkout, const fs::path& folder) {
  const fs::path script = checkout / "scripts/build_tools.sh";
  ChildLimits limits;
  limits.time = 60min;
  limits.memory_bytes = ~0ULL;
  const ChildResult child =
      runChild("/usr/bin/env", {"bash", script.string(), folder.string()}, limits);
  if (child.ending == ChildEnding::kExited && child.code == 0) return Done{};
  return fileFault(
      script.string(), "could not build " + std::string(kProgram),
      "read what it printed; or run ninja -C " + printable(folder.string()) + " wholehand_tools");
}

Expected<Done> prepare(const fs::path& tools) {
  const std::string wanted = std::string("wholehand ") + programVersion();
  const std::string found = versionOf(tools);
  if (found == wanted) return Done{};
  std::error_code error;
  const std::string problem = !fs::exists(tools, error) ? "is not there"
                              : found.empty()
                                  ? "cannot be run"
                                  : "is " + printable(found) + ", but this is " + wanted;
  const fs::path checkout = checkoutOf(tools.parent_path());
  if (checkout.empty()) {
    return fileFault(tools.string(), problem, "install both programs from one package or build");
  }
  if (const auto loop = findLoop(thisProgram())) {
    return fileFault(tools.string(), problem + ", and nothing is built beside a running loop",
                     "end the run (process " + std::to_string(*loop) + ") and repeat the command");
  }
  if (auto built = build(checkout, tools.parent_path()); !built) return built.errors();
  if (const std::string now = versionOf(tools); now != wanted) {
    return fileFault(tools.string(), "is " + printable(now) + ", but this is " + wanted,
                     "the sources have changed since this program was built: build it, too");
  }
  return Done{};
}

}  // namespace

bool isToolCommand(std::string_view name) {
  return std::any_of(std::begin(kToolCommands), std::end(kToolCommands),
                     [&](const ToolCommand& tool) { return name == tool.name; });
}

const char* toolHelp(std::string_view name) {
  const auto* found = std::find_if(std::begin(kToolCommands), std::end(kToolCommands),
                                   [&](const ToolCommand& tool) { return name == tool.name; });
  return found != std::end(kToolCommands) ? found->help : "";
}

int runTool(int argc, char** argv) {
  const fs::path tools = thisProgram().parent_path() / kProgram;
  if (auto ready = prepare(tools); !ready) return refuse(ready.errors());
  std::vector<char*> words(argv, argv + argc);
  words.push_back(nullptr);
  ::execv(tools.c_str(), words.data());
  return refuse({fileFault(tools.string(), std::string("cannot be run: ") + std::strerror(errno),
                           "install both programs from one package or build")});
}

}  // namespace wholehand
