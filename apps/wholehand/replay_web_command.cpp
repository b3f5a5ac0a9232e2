#include "replay_web_command.hpp"

#include "core/printable.hpp"
#include "exit_code.hpp"
#include "pages.hpp"
#include "replay/replay_children.hpp"
#include "replay_backend.hpp"
#include "runtime/interrupt_scope.hpp"
#include "server/http_text.hpp"
#include "server/server.hpp"
#include "telemetry/black_box_reader.hpp"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace wholehand {
namespace {

constexpr auto kLook = std::chrono::milliseconds(50);

// Checks the paths only; the page reports faults inside a file.
Diagnostics faultsOf(const std::vector<std::string>& paths) {
  Diagnostics faults;
  for (const std::string& path : paths) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
      faults.push_back({path, 0, "", "", "does not exist",
                        "give a .h5 file that `wholehand run --record` wrote"});
    } else if (!std::filesystem::is_regular_file(status)) {
      faults.push_back({path, 0, "", "", "is no regular file",
                        "give a .h5 file that `wholehand run --record` wrote"});
    } else if (BlackBoxReader::isBox(path)) {
      faults.push_back({path, 0, "", "", "is a black box, which pages do not show",
                        "take its last seconds out with --extract seconds.h5, and show that"});
    }
  }
  return faults;
}

}  // namespace

int replayWebCommand(const ReplayOptions& options) {
  std::vector<std::string> paths = {options.recording};
  if (!options.beside.empty()) paths.push_back(options.beside);
  if (Diagnostics faults = faultsOf(paths); !faults.empty()) return refuse(faults);
  const InterruptScope interrupts;
  ReplayBackend backend(paths);
  ReplayChildren children({.idle = false});
  ServerOptions server_options =
      serverOptions(PageOptions{"127.0.0.1", options.port, {}}, [](const std::string& line) {
        std::fprintf(stderr, "wholehand: %s\n", printable(line, 1000).c_str());
      });
  server_options.replay = [&children](const std::string& path, const std::string& question) {
    return children.answer(path, question);
  };
  ControlsArbiter controls;
  auto server = Server::open(backend, std::move(server_options), controls);
  if (!server) return refuse(server.errors());
  std::string url = (*server)->url() + "replay?recording=" + percentEncoded(backend.nameOf(0));
  if (paths.size() > 1) url += "&beside=" + percentEncoded(backend.nameOf(1));
  std::printf("%s\n", url.c_str());
  while (!InterruptScope::interrupted()) std::this_thread::sleep_for(kLook);
  children.end();
  return kExitInterrupted;
}

}  // namespace wholehand
