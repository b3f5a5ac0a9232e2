#include "resimulation/recorded_files.hpp"

#include "assembly/run_files.hpp"
#include "commissioning/passport.hpp"
#include "model/toml/toml_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <utility>

namespace wholehand {
namespace fs = std::filesystem;
namespace {

// A temporary folder, removed by its destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::error_code error;
    std::string pattern = (fs::temp_directory_path(error) / "wholehand-XXXXXX").string();
    if (!error && mkdtemp(pattern.data()) != nullptr) path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }  ///< empty: there is none

 private:
  fs::path path_;
};

Expected<Done> write(const fs::path& path, const std::string& text) {
  std::error_code ignored;  // the stream's state shows whether it was written
  fs::create_directories(path.parent_path(), ignored);
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (out) return Done{};
  return Diagnostic{path.string(),
                    0,
                    "",
                    "",
                    "cannot be unpacked",
                    "make room in the folder for temporary files, or set TMPDIR to another"};
}

// Of two hand files, the mirroring one is the hand. The other may not be unpacked yet.
bool mirrorsAnother(const fs::path& path) {
  TomlFile file(path.string(), "hand");
  return file.readable() && file.root().has("mirror_of");
}

// Restores the recorded files in their folder structure; each is identified by its kind.
Expected<ModelFiles> unpack(const RecordingMeta& meta, const fs::path& folder) {
  ModelFiles files{"", "", "", "", "", "", "", meta.level};
  for (const auto& [name, text] : meta.files) {
    const fs::path path = (folder / name).lexically_normal();
    const fs::path inside = path.lexically_relative(folder);
    if (inside.empty() || *inside.begin() == "..") {
      return Diagnostic{name,
                        0,
                        "",
                        "",
                        "a file of the recording lies outside its folder",
                        "the recording was tampered with"};
    }
    if (auto written = write(path, text); !written) return written.errors();
    if (path.extension() == ".csv") files.motion = path.string();
    if (path.extension() != ".toml") continue;
    auto kind = fileKind(path.string());
    if (!kind) return kind.errors();
    if (*kind == "scene") files.scene = path.string();
    if (*kind == "exercise") files.exercise = path.string();
    if (*kind == "hand" && (files.hand.empty() || mirrorsAnother(path))) files.hand = path.string();
    if (*kind == "device") files.device = path.string();
    if (*kind == "rendering") files.rendering = path.string();
    if (*kind == "patient") files.patient = path.string();
  }
  const std::pair<const char*, const std::string*> needed[] = {{"scene", &files.scene},
                                                               {"hand", &files.hand},
                                                               {"device", &files.device},
                                                               {"rendering", &files.rendering},
                                                               {"patient", &files.patient}};
  Diagnostics missing;
  for (const auto& [kind, file] : needed) {
    if (!file->empty()) continue;
    missing.push_back({"", 0, "", "", fmt::format("the recording carries no {} file", kind),
                       "copy it again from where it was recorded"});
  }
  if (!missing.empty()) return missing;
  return files;
}

// Names the recording instead of the temporary folder in faults.
Diagnostics named(Diagnostics errors, const fs::path& folder, const std::string& recording) {
  for (Diagnostic& error : errors) {
    const std::string prefix = folder.string() + "/";
    const bool unpacked = error.file.rfind(prefix, 0) == 0;
    const std::string inside = unpacked ? error.file.substr(prefix.size()) : error.file;
    error.file = inside.empty() ? recording : recording + ": " + inside;
  }
  return errors;
}

}  // namespace

Expected<Models> recordedModels(const RecordingMeta& meta, const std::string& recording) {
  const TemporaryFolder folder;
  if (folder.path().empty()) {
    return Diagnostic{recording,
                      0,
                      "",
                      "",
                      "there is no folder to unpack it into",
                      "set TMPDIR to a folder that you may write to"};
  }
  auto files = unpack(meta, folder.path());
  if (!files) return named(files.errors(), folder.path(), recording);
  auto models = loadModels(*files);
  if (!models) return named(models.errors(), folder.path(), recording);
  for (std::string* file :
       {&models->files.scene, &models->files.hand, &models->files.device, &models->files.rendering,
        &models->files.patient, &models->files.exercise}) {
    if (file->empty()) continue;
    *file = recording + ": " + fs::path(*file).lexically_relative(folder.path()).string();
  }
  return models;
}

Expected<std::vector<DeviceModel>> recordedCorners(const RecordingMeta& meta,
                                                   const DeviceModel& device,
                                                   const std::string& recording) {
  const auto carried = std::find_if(meta.files.begin(), meta.files.end(), [](const auto& file) {
    return file.first == kRecordedPassport;
  });
  if (carried == meta.files.end()) return std::vector<DeviceModel>();
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "passport.toml";
  if (auto written = write(path, carried->second); !written) return written.errors();
  const auto passport = readPassport(path.string());
  if (!passport) return named(passport.errors(), folder.path(), recording);
  if (sameAxes(*passport, device)) return worstCorners(device, *passport, meta.period_s);
  return Diagnostic{recording,
                    0,
                    "",
                    "",
                    "its passport is of a device with other axes",
                    "the recording was tampered with"};
}

}  // namespace wholehand
