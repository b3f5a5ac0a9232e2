#include "exercise/load_exercise.hpp"

#include "exercise/free_grasping/free_grasping.hpp"
#include "exercise_kinds.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace wholehand {

namespace fs = std::filesystem;

Expected<LoadedExercise> loadExercise(const std::string& path, int level, const DeviceModel& device,
                                      const HandModel& hand) {
  TomlFile file(path, "exercise");
  if (!file.readable()) return file.finish();
  TomlTable& root = file.root();
  std::vector<std::string> names;
  for (const ExerciseKind& kind : kExerciseKinds) names.emplace_back(kind.name);
  const std::string wanted = root.choice("exercise", names);
  ExerciseSource source;
  source.path = path;
  source.name = root.text("name");
  source.level = level;
  source.device = &device;
  source.hand = &hand;
  const std::string scene = root.text("scene");
  source.scene_path = root.good("scene") ? (fs::path(path).parent_path() / scene).string() : "";
  if (!root.good("exercise")) {
    root.skipRest();  // which keys belong here is not known
    return file.finish();
  }
  const auto at = std::find(names.begin(), names.end(), wanted) - names.begin();
  return kExerciseKinds[at].load(file, source);
}

LoadedExercise freeGraspingIn(SceneModel scene, const DeviceModel& device) {
  return free_grasping::inScene(std::move(scene), "free-grasping", device);
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
