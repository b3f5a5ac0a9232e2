#include "replay_backend.hpp"

#include <algorithm>
#include <filesystem>

namespace wholehand {
namespace fs = std::filesystem;

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

}  // namespace wholehand
