#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/shipped_files.hpp"
#include "apps/wholehand/validate/validate_command.hpp"
#include "files/scene/object_scene.hpp"
#include "files/toml/toml_file.hpp"
#include "loop/core/printable.hpp"
#include "rig/admission.hpp"
#include "rig/rehearsal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <vector>

namespace wholehand {
namespace {

/// The first names, and the number of the others.
std::string listOf(const std::vector<std::string>& names) {
  constexpr std::size_t kNamed = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kNamed); ++i) {
    text += (i > 0 ? ", " : "") + printable(names[i]);
  }
  if (names.size() > kNamed) text += fmt::format(" and {} more", names.size() - kNamed);
  return text;
}

/// The exercise that plays the scene, from the folder `exercises` next to the scene's folder;
/// empty: none does.
std::string exerciseOf(const std::string& scene) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<fs::path> found;
  const fs::path folder = (fs::path(scene).parent_path() / "../exercises").lexically_normal();
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (at->path().extension() != ".toml") continue;
    TomlFile file(at->path().string(), "exercise");
    if (!file.readable()) continue;
    std::error_code none;
    if (fs::equivalent(folder / file.root().text("scene"), scene, none)) found.push_back(*at);
  }
  return found.empty() ? "" : std::min_element(found.begin(), found.end())->string();
}

/// Faults of a scene alone. An exercise may begin at another position than the device's rest.
Diagnostics withExercise(Diagnostics faults, const std::string& scene) {
  const std::string exercise = scene.empty() ? "" : exerciseOf(scene);
  if (exercise.empty()) return faults;
  for (Diagnostic& fault : faults) {
    fault.remedy += "; an exercise plays it: wholehand validate --admit " + printable(exercise);
  }
  return faults;
}

/// @param too_slow fault if the bodies of a game are too slow
void print(const Admission& a, const AdmitOptions& options, const Diagnostic& too_slow) {
  std::printf("%s: %s at %.0f Hz with %s\n  %s\n", printable(options.scene).c_str(),
              a.admitted ? "admitted" : "not admitted", options.rate_hz, options.engine.c_str(),
              describe(a.measured).c_str());
  if (a.pool) std::printf("  %s\n", describe(a.pool->measured).c_str());
  if (a.admitted) return;
  if (a.pool) {
    std::printf("  %s\n", format(Diagnostics{too_slow}).c_str());
    return;
  }
  if (a.remove.empty()) {
    std::printf(
        "  No body that could be removed is enough: use a slower rate, or a faster machine.\n");
    return;
  }
  std::printf("  Remove %zu %s: %s\n  then %s\n", a.remove.size(),
              a.remove.size() == 1 ? "body" : "bodies", listOf(a.remove).c_str(),
              describe(a.without).c_str());
}

}  // namespace

int admitCommand(const AdmitOptions& options) {
  ModelFiles files;
  const auto kind =
      isUrdf(options.scene) ? Expected<std::string>("scene") : fileKind(options.scene);
  if (!kind) return refuse(kind.errors());
  if (*kind == "exercise") {
    files.scene.clear();
    files.exercise = options.scene;
  } else {
    files.scene = options.scene;
  }
  files.hand = options.hand;
  files.device = options.device;
  files.rendering = options.rendering;
  files.patient = shippedFile(files.patient);
  auto models = loadModels(files);
  if (!models) return refuse(models.errors());
  printNotices(models->scene.notices, 2);
  RigOptions rig;
  rig.period_s = 1.0 / options.rate_hz;
  rig.engine = options.engine;
  const auto admission = admit(*models, rig, {}, [](const std::string& what) {
    std::printf("measuring %s\n", what.c_str());
    std::fflush(stdout);
  });
  if (!admission) return refuse(withExercise(admission.errors(), files.scene));
  const Diagnostic too_slow =
      admission->pool ? poolTooSlow(*admission->pool, *models) : Diagnostic{};
  print(*admission, options, too_slow);
  return admission->admitted ? kExitDone : kExitNotFit;
}

}  // namespace wholehand
