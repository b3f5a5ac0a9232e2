#include "station/session_files.hpp"

#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"
#include "record/recording.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace wholehand {

namespace fs = std::filesystem;

namespace {

/// True for characters that a file name keeps. Bytes from 0x80 on are parts of UTF-8 characters;
/// printable() has removed all invalid ones.
bool stays(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}

bool beginsCharacter(char c) {
  return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
}

constexpr const char* kExtension = ".h5";
constexpr std::uintmax_t kLargestNote_bytes = 65536;  // the JSON files written here have about 200
                                                      // bytes

std::string notePath(const fs::path& recording) {
  return recording.string() + ".json";
}

// Reads a recording's JSON file; a missing or damaged one leaves the entry unchanged.
void readNote(const fs::path& recording, RecordingEntry& entry) {
  std::error_code error;
  if (fs::file_size(notePath(recording), error) > kLargestNote_bytes || error) return;
  std::ifstream in(notePath(recording));
  const auto note = nlohmann::json::parse(in, nullptr, false);
  if (!note.is_object()) return;
  const auto text = [&note](const char* key) {
    const auto found = note.find(key);
    return found != note.end() && found->is_string() ? found->get<std::string>() : std::string();
  };
  entry.title = text("title");
  entry.profile = text("profile");
  entry.created_utc = text("created_utc");
  if (const auto found = note.find("duration_s"); found != note.end() && found->is_number()) {
    entry.duration_s = found->get<double>();
  }
  if (const auto found = note.find("ticks_missing");
      found != note.end() && found->is_number_unsigned()) {
    entry.ticks_missing = found->get<std::uint64_t>();
  }
}

}  // namespace

std::string fileNamePart(std::string_view text, std::size_t most_bytes) {
  std::string out;
  for (const char c : printable(text, most_bytes)) {
    if (stays(c)) {
      out += c;
    } else if (!out.empty() && out.back() != '-') {
      out += '-';
    }
  }
  if (out.size() > most_bytes) {
    std::size_t end = most_bytes;
    while (end > 0 && !beginsCharacter(out[end])) --end;
    out.resize(end);
  }
  while (!out.empty() && out.back() == '-') out.pop_back();
  return out;
}

std::string utcNow() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::now()));
}

Expected<std::string> SessionFiles::nameNew(const std::string& person, const std::string& exercise,
                                            int level) const {
  const auto refusal = [this](const std::string& why) {
    return fileFault(folder_, "takes no new recording: " + why,
                     "make room, or start the program in a folder that you may write to");
  };
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) return refusal(error.message());
  const std::string who = fileNamePart(person), what = fileNamePart(exercise);
  const std::string stem =
      fmt::format("{}/{:%Y%m%d-%H%M%S}-{}{}{}-level-{}", folder_, fmt::localtime(now_()), who,
                  who.empty() ? "" : "-", what.empty() ? "scene" : what, level);
  std::string path;
  if (const int failed = takeNewName(stem, kExtension, path); failed != 0) {
    return refusal(std::strerror(failed));
  }
  return path;
}

bool SessionFiles::isInside(const std::string& path) const {
  return kept() && !path.empty() && fs::path(path).parent_path() == fs::path(folder_);
}

void SessionFiles::giveBack(const std::string& path) const {
  std::error_code error;
  const auto bytes = isInside(path) ? fs::file_size(path, error) : 1;
  if (!error && bytes == 0) fs::remove(path, error);
}

void SessionFiles::remove(const std::string& path) const {
  if (!isInside(path)) return;
  std::error_code error;
  for (const std::string& part : recordingParts(path)) fs::remove(part, error);
  fs::remove(path, error);
}

void SessionFiles::note(const std::string& path, const std::string& title,
                        const std::string& person, const std::string& began_utc, double duration_s,
                        std::uint64_t ticks_missing) const {
  if (!isInside(path)) return;
  const nlohmann::json note = {{"title", title},
                               {"profile", person},
                               {"created_utc", began_utc},
                               {"duration_s", duration_s},
                               {"ticks_missing", ticks_missing}};
  (void)writeText(notePath(path), note.dump(2) + "\n");  // on failure the list describes the HDF5
                                                         // file alone
}

std::vector<RecordingEntry> SessionFiles::list(const std::string& being_written) const {
  std::vector<RecordingEntry> entries;
  std::error_code error;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const fs::path& path = it->path();
    if (path.extension() != kExtension) continue;
    std::error_code gone;  // path() refuses symbolic links, so they are skipped
    if (!fs::is_regular_file(it->symlink_status(gone))) continue;
    RecordingEntry entry;
    entry.name = path.filename().string();
    entry.title = path.stem().string();
    std::error_code unknown;
    entry.bytes = fs::file_size(path, unknown);
    if (unknown) continue;
    std::error_code elsewhere;
    entry.being_written = fs::equivalent(path, being_written, elsewhere);
    if (entry.bytes == 0 && !entry.being_written) continue;  // only reserves its name
    if (!entry.being_written) readNote(path, entry);
    entries.push_back(std::move(entry));
  }
  // Adds a recording in progress outside the folder.
  const fs::path outside = outsidePath(being_written);
  std::error_code unknown;
  if (const auto bytes = outside.empty() ? 0 : fs::file_size(outside, unknown);
      !outside.empty() && !unknown) {
    RecordingEntry entry;
    entry.name = outside.filename().string();
    entry.title = outside.stem().string();
    entry.bytes = bytes;
    entry.being_written = true;
    entries.push_back(std::move(entry));
  }
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return a.name > b.name; });
  return entries;
}

std::string SessionFiles::outsidePath(const std::string& being_written) const {
  const fs::path file(being_written);
  std::error_code error;
  const bool inside = fs::exists(fs::path(folder_) / file.filename(), error);
  return inside || file.extension() != kExtension ? std::string() : being_written;
}

std::string SessionFiles::path(const std::string& name, const std::string& being_written) const {
  const fs::path file(name);
  if (!kept() || name.empty() || file.filename() != file || file.extension() != kExtension) {
    return {};
  }
  std::error_code error;
  const fs::path path = fs::path(folder_) / file;
  if (fs::is_regular_file(fs::symlink_status(path, error))) return path.string();
  const std::string outside = outsidePath(being_written);
  return fs::path(outside).filename() == file ? outside : std::string();
}

std::string pathOfSession(const std::string& path, std::uint64_t number) {
  if (number < 2 || path.empty()) return path;
  const fs::path first(path);
  const std::string name =
      first.stem().string() + "-" + std::to_string(number) + first.extension().string();
  return (first.parent_path() / name).string();
}

}  // namespace wholehand
