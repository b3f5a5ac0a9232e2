#include "bar_experiments.hpp"
#include "chart_file.hpp"
#include "core/printable.hpp"
#include "exercise_figure.hpp"
#include "exit_code.hpp"
#include "experiments/exercise_script.hpp"
#include "experiments/exercise_trial.hpp"
#include "json_text.hpp"
#include "runtime/interrupt_scope.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <string>

namespace wholehand {
namespace {

using Json = nlohmann::ordered_json;

Json resultJson(const ExerciseResult& r, const ExerciseOptions& options) {
  Json json;
  json["engine"] = options.engine;
  json["completed"] = r.completed;
  json["phases"] = Json::array();
  for (const ExercisePhase& p : r.phases) {
    json["phases"].push_back({{"name", p.name}, {"start_s", p.start_s}, {"end_s", p.end_s}});
  }
  for (std::size_t a = 0; a < r.axis_names.size(); ++a) {
    json["phi_peak"][r.axis_names[a]] = r.phi_peak[static_cast<int>(a)];
    if (r.fading_s[a] > 0.0) json["phi_fading_s"][r.axis_names[a]] = r.fading_s[a];
  }
  json["alpha_max"] = r.alpha_max;
  json["wall_pull_max_n"] = r.wall_pull_max_n;
  json["wall_push_max_n"] = r.wall_push_max_n;
  json["volume_error_l"] = r.volume_error_l;
  json["asked_l"] = r.asked_l;
  json["tolerance_l"] = r.tolerance_l;
  json["poured_l"] = r.poured_l;
  json["spilt_l"] = r.spilt_l;
  json["squeeze_max_n"] = r.squeeze_max_n;
  json["bumps"] = Json::array();
  for (const ExerciseBump& b : r.bumps) {
    json["bumps"].push_back(
        {{"start_s", b.start_s}, {"end_s", b.end_s}, {"contact_max_n", b.contact_n}});
  }
  json["seed"] = options.seed;
  return json;
}

void print(const ExerciseResult& r) {
  for (std::size_t i = 0; i < r.phases.size(); ++i) {
    const ExercisePhase& p = r.phases[i];
    std::printf("%zu %-9s %6.2f to %5.2f s\n", i + 1, p.name.c_str(), p.start_s, p.end_s);
  }
  if (r.phases.empty()) std::printf("the four phases are not in the data\n");
  for (std::size_t a = 0; a < r.axis_names.size(); ++a) {
    std::printf("phi of %-20s peak %.2f", r.axis_names[a].c_str(), r.phi_peak[static_cast<int>(a)]);
    if (r.fading_s[a] > 0.0) std::printf(", fades with %.3f s after the bump", r.fading_s[a]);
    std::printf("\n");
  }
  std::printf("wall: pulls with %.3g N at most, pushes with %.2f N\n", r.wall_pull_max_n,
              r.wall_push_max_n);
  std::printf("%.1f ml of %.1f ml, %.1f ml spilt, volumes add up to %.1g l: %s\n", 1e3 * r.poured_l,
              1e3 * r.asked_l, 1e3 * r.spilt_l, r.volume_error_l,
              r.completed ? "completed" : "not completed");
}

}  // namespace

int exerciseCommand(const ExerciseOptions& options) {
  auto files = barModelFiles(options.files);
  if (!files) return refuse(files.errors());
  const auto named = [&](const std::string& path, const char* name) {
    return path.empty() ? options.folder + "/" + name : path;
  };
  const std::string json_path = named(options.json, "exercise.json");
  const std::string chart_path = named(options.charts, "exercise.html");
  const std::string record_path = named(options.record, "exercise.h5");
  if (auto ready = prepareCharts(chart_path, {json_path, record_path}); !ready) {
    return refuse(ready.errors());
  }
  ExercisePlan plan;
  plan.files = *files;
  plan.rig.engine = options.engine;
  plan.seed = options.seed;
  plan.record = record_path;
  const InterruptScope interrupts;
  auto result = runExercise(plan);
  if (!result) return refuse(result.errors());
  if (result->interrupted) return sayInterrupted();
  if (auto done = writeResults(jsonText(resultJson(*result, options)), exerciseFigure(*result),
                               {json_path, chart_path});
      !done) {
    return refuse(done.errors());
  }
  print(*result);
  std::printf("%s\n%s\n%s\n", printable(json_path).c_str(), printable(chart_path).c_str(),
              printable(record_path).c_str());
  return exitCodeOf(result->faulted, false);
}

}  // namespace wholehand
