#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "experiments/cocktail_trial.hpp"
#include "experiments/worker_pool.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/run/run.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <string>
#include <thread>
#include <vector>

namespace wholehand {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(CocktailResult, completed, score, spilt_l, amount_error_max_l,
                                   steps, steps_in_tolerance, wrong_dispenser, knocked_over,
                                   volume_error_l, time_s, step_max_s, wall_s, faulted, interrupted)

namespace {

using Json = nlohmann::ordered_json;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

using Results = std::vector<CocktailResult>;

std::vector<double> each(const Results& results, double CocktailResult::*figure) {
  std::vector<double> out;
  for (const CocktailResult& r : results) out.push_back(r.*figure);
  return out;
}

double largest(const Results& results, double CocktailResult::*figure) {
  double out = 0.0;
  for (const CocktailResult& r : results) out = std::max(out, r.*figure);
  return out;
}

int sum(const Results& results, int CocktailResult::*figure) {
  int out = 0;
  for (const CocktailResult& r : results) out += r.*figure;
  return out;
}

Json levelJson(int level, const Results& results) {
  Json failed = Json::array();
  double lowest = 100.0, time_s = 0.0, wall_s = 0.0;
  for (const CocktailResult& r : results) {
    if (!r.completed) failed.push_back(r.seed);
    lowest = std::min(lowest, r.score);
    time_s += r.time_s;
    wall_s += r.wall_s;
  }
  return {{"level", level},
          {"seeds", results.size()},
          {"completed", results.size() - failed.size()},
          {"score_median", median(each(results, &CocktailResult::score))},
          {"score_min", lowest},
          {"spilt_l_median", median(each(results, &CocktailResult::spilt_l))},
          {"spilt_l_max", largest(results, &CocktailResult::spilt_l)},
          {"amount_error_l_median", median(each(results, &CocktailResult::amount_error_max_l))},
          {"amount_error_l_max", largest(results, &CocktailResult::amount_error_max_l)},
          {"steps", sum(results, &CocktailResult::steps)},
          {"steps_in_tolerance", sum(results, &CocktailResult::steps_in_tolerance)},
          {"wrong_dispenser", sum(results, &CocktailResult::wrong_dispenser)},
          {"knocked_over", sum(results, &CocktailResult::knocked_over)},
          {"volume_error_l_max", largest(results, &CocktailResult::volume_error_l)},
          {"time_s_median", median(each(results, &CocktailResult::time_s))},
          {"step_s_max", largest(results, &CocktailResult::step_max_s)},
          {"real_time_factor", wall_s > 0.0 ? time_s / wall_s : 0.0},
          {"failed_seeds", failed}};
}

void printHeader() {
  std::printf("%5s %6s %10s %8s %8s %10s %12s %8s %8s %12s\n", "level", "seeds", "completed",
              "score", "lowest", "spilt ml", "off by ml", "time s", "step s", "x real time");
}

void printLevel(const Json& j) {
  std::printf("%5d %6d %10d %8.1f %8.1f %10.2f %12.2f %8.1f %8.1f %12.1f\n", j["level"].get<int>(),
              j["seeds"].get<int>(), j["completed"].get<int>(), j["score_median"].get<double>(),
              j["score_min"].get<double>(), 1e3 * j["spilt_l_median"].get<double>(),
              1e3 * j["amount_error_l_median"].get<double>(), j["time_s_median"].get<double>(),
              j["step_s_max"].get<double>(), j["real_time_factor"].get<double>());
  for (const auto& seed : j["failed_seeds"]) {
    std::printf("      not completed: --level %d --first-seed %llu --seeds 1\n",
                j["level"].get<int>(), seed.get<unsigned long long>());
  }
  std::fflush(stdout);
}

// Requested levels. Faults of the files are reported here once, not by every worker.
Expected<std::vector<int>> levelsAsked(const CocktailOptions& options, ModelFiles files) {
  files.level = std::max(options.level, 1);
  auto models = loadModels(files);
  if (!models) return models.errors();
  if (options.level > 0) return std::vector<int>{options.level};
  std::vector<int> levels;
  for (int level = 1; level <= models->exercise->description().levels; ++level) {
    levels.push_back(level);
  }
  return levels;
}

struct Played {
  Results results;
  std::string refused;
  bool complete = false;  ///< every worker finished
};

Played play(const CocktailOptions& options, const ModelFiles& files, int level) {
  Played played;
  played.results.resize(static_cast<std::size_t>(options.seeds));
  std::vector<bool> known(played.results.size(), false);
  // A worker process plays one virtual patient and returns a line of JSON.
  const auto work = [&](int job) -> std::string {
    CocktailPlan plan;
    plan.files = files;
    plan.rig.engine = options.engine;
    plan.parameters = options.parameters;
    plan.files.level = level;
    plan.seed = options.first_seed + static_cast<std::uint64_t>(job);
    if (InterruptScope::interrupted()) return Json{{"stopped", true}}.dump();
    auto result = runCocktail(plan);
    return result ? nlohmann::json(*result).dump()
                  : Json{{"refused", format(result.errors())}}.dump();
  };
  // This process collects the lines.
  int reported = 0, completed = 0;
  const auto done = [&](int job, const std::string& line) {
    const auto json = nlohmann::json::parse(line, nullptr, false);
    if (json.is_discarded() || json.contains("stopped")) return;
    if (json.contains("refused")) {
      played.refused = json["refused"];
      return;
    }
    CocktailResult& result = played.results[job];
    result = json.get<CocktailResult>();
    result.level = level;
    result.seed = options.first_seed + static_cast<std::uint64_t>(job);
    known[job] = true;
    completed += result.completed ? 1 : 0;
    if (++reported % 10 == 0) {
      std::fprintf(stderr, "level %d: %d of %d, %d completed\n", level, reported, options.seeds,
                   completed);
    }
  };
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  played.complete =
      workInProcesses(options.seeds, options.processes > 0 ? options.processes : cores, work, done,
                      InterruptScope::interrupted);
  played.complete =
      played.complete && std::all_of(known.begin(), known.end(), [](bool k) { return k; });
  return played;
}

}  // namespace

int cocktailCommand(const CocktailOptions& options) {
  const InterruptScope interrupts;
  auto files = barModelFiles(options.files);
  if (!files) return refuse(files.errors());
  auto levels = levelsAsked(options, *files);
  if (!levels) return refuse(levels.errors());
  if (!options.json.empty()) {
    if (auto ready = prepareFiles({options.json}); !ready) return refuse(ready.errors());
  }
  // Plays every requested level.
  printHeader();
  Json json;
  json["exercise"] = files->exercise;
  json["engine"] = options.engine;
  json["first_seed"] = options.first_seed;
  json["levels"] = Json::array();
  bool faulted = false;
  for (const int level : *levels) {
    const Played played = play(options, *files, level);
    if (InterruptScope::interrupted()) return printInterrupted();
    if (!played.refused.empty()) {
      std::fprintf(stderr, "wholehand: %s\n", played.refused.c_str());
      return kExitBadInput;
    }
    if (!played.complete) {
      std::fprintf(stderr, "wholehand: a process that played level %d died\n", level);
      return kExitFault;
    }
    for (const CocktailResult& r : played.results) faulted = faulted || r.faulted;
    json["levels"].push_back(levelJson(level, played.results));
    printLevel(json["levels"].back());
  }
  if (!options.json.empty()) {
    if (auto done = writeText(options.json, jsonText(json)); !done) return refuse(done.errors());
    std::printf("%s\n", printable(options.json).c_str());
  }
  if (faulted) std::printf("FAULT    patients stopped by a fault\n");
  return exitCodeOf(faulted, false);
}

}  // namespace wholehand
