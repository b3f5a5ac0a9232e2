#include "exercises/load_exercise.hpp"

#include "exercise_kinds.hpp"
#include "files/exercise/exercise_panel_file.hpp"
#include "files/scene/scene_file.hpp"
#include "loop/core/printable.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

namespace wholehand {

namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestName = 100;

/// Path of the scene that the file names; reports a missing scene and returns an empty path.
std::string scenePath(TomlTable& root, const std::string& exercise_path) {
  const std::string named = root.text("scene");
  if (!root.isGood("scene")) return {};
  const fs::path path = (fs::path(exercise_path).parent_path() / named).lexically_normal();
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error)) return path.string();
  root.fail("scene", "there is no file " + printable(path.string()),
            "write the path of a scene file, relative to the folder of this file");
  return {};
}

/// Loads the exercise and its table [panel], common to all kinds, and checks the panel's names.
Expected<LoadedExercise> loadWithPanel(TomlFile& file, const ExerciseKind& kind,
                                       const ExerciseSource& source) {
  std::optional<TomlTable> table = file.root().optionalTable("panel");
  ExercisePanel panel = table ? readExercisePanel(*table) : ExercisePanel{};
  Expected<LoadedExercise> loaded = kind.load(file, source);
  if (!loaded || !table) return loaded;
  const ExerciseDescription& description = loaded->exercise->description();
  checkExercisePanel(*table, panel, description.value_names, description.event_names);
  if (Diagnostics faults = file.finish(); !faults.empty()) return faults;
  loaded->panel = std::move(panel);
  return loaded;
}

/// Loads the exercise together with its scene and reports the faults of both files.
Expected<LoadedExercise> loadWithScene(TomlFile& file, const ExerciseKind& kind,
                                       ExerciseSource source, const std::string& scene_path) {
  Expected<SceneModel> scene = Diagnostics{};
  if (!scene_path.empty()) scene = loadSceneFile(scene_path);
  if (scene) {
    // For a left hand the kind mirrors the scene in y afterwards.
    const double mirror = source.hand->side == Side::kLeft ? -1.0 : 1.0;
    for (SceneBody& body : scene->bodies) {
      body.pose.translation_m += source.moved_m.cwiseProduct(Eigen::Vector3d(1.0, mirror, 1.0));
    }
    source.scene = &*scene;
  }
  Expected<LoadedExercise> loaded = loadWithPanel(file, kind, source);
  if (!scene) {
    Diagnostics faults = loaded.errors();
    faults.insert(faults.end(), scene.errors().begin(), scene.errors().end());
    return faults;
  }
  if (!loaded) return loaded;
  loaded->files = {source.path, scene->path};
  loaded->scene = std::move(*scene);
  loaded->moved_m = source.moved_m;
  return loaded;
}

/// Lists the exercises of the folder in the error of a missing file.
Diagnostics namingOthers(Diagnostics faults, const std::string& path) {
  std::error_code error;
  if (fs::exists(path, error)) return faults;
  std::string others;
  const std::string folder = fs::path(path).parent_path().string();
  for (const ExerciseFile& other : listExercises(folder.empty() ? "." : folder)) {
    others += (others.empty() ? "" : ", ") + other.name;
  }
  if (others.empty()) return faults;
  for (Diagnostic& fault : faults) fault.remedy = "exercises there: " + others;
  return faults;
}

/// Loads the exercise with its scene moved by `moved_m`.
Expected<LoadedExercise> loadAt(const std::string& path, ExerciseSource source) {
  TomlFile file(path, "exercise");
  if (!file.readable()) return namingOthers(file.finish(), path);
  TomlTable& root = file.root();
  std::vector<std::string> names;
  for (const ExerciseKind& kind : kExerciseKinds) names.emplace_back(kind.name);
  const std::string wanted = root.choice("exercise", names);
  source.path = path;
  source.name = root.text("name");
  if (source.name.find('/') != std::string::npos || source.name.size() > kLongestName) {
    root.fail("name", "cannot be part of a file's name, as that of a recording",
              "at most 100 bytes, without a slash");
  }
  const std::string scene_path = scenePath(root, path);
  if (!root.isGood("exercise")) {
    root.ignoreUnknownKeys();  // the keys of an unknown kind cannot be checked
    return file.finish();
  }
  const auto at = std::find(names.begin(), names.end(), wanted) - names.begin();
  return loadWithScene(file, kExerciseKinds[at], source, scene_path);
}

}  // namespace

Expected<LoadedExercise> loadExercise(const std::string& path, int level, const DeviceModel& device,
                                      const HandModel& hand, BearsWalls bears,
                                      const Prescription* prescription) {
  ExerciseSource source;
  source.level = level;
  source.device = source.whole = &device;
  source.hand = &hand;
  source.bears = std::move(bears);
  if (prescription == nullptr) return loadAt(path, source);
  const DeviceModel within = deviceWithin(device, *prescription);
  source.device = &within;
  Expected<LoadedExercise> loaded = loadAt(path, source);
  if (!loaded) return loaded;
  const auto moved_m =
      placeWithin(loaded->needs, within, loaded->exercise->description().name, *prescription);
  if (!moved_m) return moved_m.errors();
  if (moved_m->isZero()) return loaded;
  source.moved_m = *moved_m;
  return loadAt(path, source);
}

std::vector<ExerciseFile> listExercises(const std::string& folder) {
  std::vector<ExerciseFile> found;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".toml") continue;
    const Expected<std::string> kind = fileKind(entry.path().string());
    if (!kind || *kind != "exercise") continue;
    found.push_back({entry.path().stem().string(), entry.path().string()});
  }
  std::sort(found.begin(), found.end(),
            [](const ExerciseFile& a, const ExerciseFile& b) { return a.name < b.name; });
  return found;
}

}  // namespace wholehand
