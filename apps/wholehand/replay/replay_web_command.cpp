#include "apps/wholehand/replay/replay_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/pages.hpp"
#include "loop/core/printable.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "record/black_box_reader.hpp"
#include "replay/replay_children.hpp"
#include "station/server/http_line.hpp"
#include "station/server/server.hpp"
#include "vocabulary/backend.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

/// Backend of a server without a loop. It shows recordings and refuses every order.
class ReplayBackend final : public ServerBackend {
 public:
  /// @param paths recordings; the second of two equal file names is listed as "2-<name>"
  explicit ReplayBackend(const std::vector<std::string>& paths);

  /// Name of a recording in /api/recordings.
  [[nodiscard]] const std::string& nameOf(std::size_t i) const { return files_[i].first; }

  void order(const Order& order, std::function<void(OrderReply)> done) override;
  [[nodiscard]] std::shared_ptr<const SceneFacts> scene() const override { return nullptr; }
  [[nodiscard]] LoopStatus status() const override { return {}; }
  [[nodiscard]] bool latest(TickRecord&) const override { return false; }
  [[nodiscard]] std::vector<RecordingEntry> recordings() const override;
  [[nodiscard]] std::string recordingPath(const std::string& name) const override;
  [[nodiscard]] std::string reportFolder(const std::string& name, std::string& why) override;

 private:
  std::vector<std::pair<std::string, std::string>> files_;  ///< name, path
};

ReplayBackend::ReplayBackend(const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    const std::string name = fs::path(path).filename().string();
    const bool taken = !recordingPath(name).empty();
    files_.emplace_back(taken ? "2-" + name : name, path);
  }
}

void ReplayBackend::order(const Order&, std::function<void(OrderReply)> done) {
  done(refused(Refusal::kNotHere, "nothing runs here: recordings are shown"));
}

std::vector<RecordingEntry> ReplayBackend::recordings() const {
  std::vector<RecordingEntry> entries;
  for (const auto& [name, path] : files_) {
    RecordingEntry entry;
    entry.name = name;
    entry.title = fs::path(path).stem().string();
    std::error_code unknown;
    entry.bytes = fs::file_size(path, unknown);
    if (!unknown) entries.push_back(std::move(entry));
  }
  return entries;
}

std::string ReplayBackend::recordingPath(const std::string& name) const {
  const auto found = std::find_if(files_.begin(), files_.end(),
                                  [&](const auto& file) { return file.first == name; });
  return found == files_.end() ? std::string() : found->second;
}

std::string ReplayBackend::reportFolder(const std::string& name, std::string& why) {
  why = "try: wholehand report " + recordingPath(name) + " --out report";
  return {};
}

constexpr auto kLook = std::chrono::milliseconds(50);

// Checks only the paths; the page reports faults inside a file.
Diagnostics faultsOf(const std::vector<std::string>& paths) {
  Diagnostics faults;
  for (const std::string& path : paths) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) {
      faults.push_back(
          fileFault(path, "does not exist", "give a .h5 file that `wholehand run --record` wrote"));
    } else if (!std::filesystem::is_regular_file(status)) {
      faults.push_back(fileFault(path, "is no regular file",
                                 "give a .h5 file that `wholehand run --record` wrote"));
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
  ReplayChildren children({.idle_disk = false});
  ServerOptions server_options =
      serverOptions(PageOptions{"127.0.0.1", options.port, {}}, [](const std::string& line) {
        std::fprintf(stderr, "wholehand: %s\n", printable(line, 1000).c_str());
      });
  server_options.replay = [&children](const std::string& path, const std::string& question) {
    return children.answer(path, question);
  };
  ControlHolder controls;
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
