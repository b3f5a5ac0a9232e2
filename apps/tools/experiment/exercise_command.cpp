#include "apps/tools/experiment/experiment_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "experiments/exercise_script.hpp"
#include "experiments/exercise_trial.hpp"
#include "files/page/chart_page.hpp"
#include "loop/core/printable.hpp"
#include "loop/runtime/interrupt_scope.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <string>

namespace wholehand {
namespace {

constexpr double kTipScale_n = 7.5;  // makes fingers and thumb comparable
constexpr double kStep_s = 0.02;     // interval of a line; minimum and maximum are drawn
constexpr std::array<const char*, 4> kHeadings = {"exercise.bumps", "exercise.approaches",
                                                  "exercise.squeezes", "exercise.letsGo"};

using Value = std::function<double(const ExerciseSample&)>;

/// Reduces every interval of kStep_s to its extremes, in order, so that no spike is lost.
std::vector<std::array<double, 2>> points(const ExerciseResult& result, const Value& value) {
  std::vector<std::array<double, 2>> out;
  const auto& samples = result.samples;
  for (std::size_t i = 0; i < samples.size();) {
    std::array<double, 2> low{samples[i].time_s, value(samples[i])}, high = low;
    const double end_s = samples[i].time_s + kStep_s;
    for (; i < samples.size() && samples[i].time_s < end_s; ++i) {
      const std::array<double, 2> p{samples[i].time_s, value(samples[i])};
      if (p[1] < low[1]) low = p;
      if (p[1] > high[1]) high = p;
    }
    out.push_back(low[0] < high[0] ? low : high);
    if (low[0] != high[0]) out.push_back(low[0] < high[0] ? high : low);
  }
  return out;
}

int axisOf(const ExerciseResult& result, const std::string& name) {
  const auto& names = result.axis_names;
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

ChartLine lineOf(const ExerciseResult& result, int axis, const Value& value) {
  ChartLine line;
  line.axis = result.axis_names[axis];
  line.points = points(result, value);
  return line;
}

Chart panel(const ExerciseResult& result, const char* title, int height_px) {
  Chart chart;
  chart.title = sentence(title);
  chart.height_px = height_px;
  chart.names_x = false;
  chart.below_previous = true;
  chart.x = {"s", 0.0, result.samples.empty() ? 1.0 : result.samples.back().time_s};
  for (const ExercisePhase& phase : result.phases) {
    chart.bands.push_back({phase.start_s, phase.end_s});
    chart.marks.push_back({phase.start_s, nullptr});
  }
  return chart;
}

/// Adds efforts sent to these axes: in N at the tip if there is one; circumduction, which has none,
/// in 0.1 N·m for visibility.
void addEfforts(Chart& chart, const ExerciseResult& result, const std::vector<const char*>& names) {
  for (const char* name : names) {
    const int a = axisOf(result, name);
    if (a < 0) continue;
    const double arm_m = result.lever_arms_m[a];
    const bool turn = std::string(name) == "thumb_circumduction";
    const double unit = turn ? 0.1 : arm_m > 0.0 ? arm_m : 1.0;
    chart.lines.push_back(
        lineOf(result, a, [a, unit](const ExerciseSample& s) { return s.sent[a] / unit; }));
  }
}

Chart phiPanel(const ExerciseResult& result) {
  Chart chart = panel(result, "exercise.phi", 74);
  chart.y = {"", -0.04, 1.12};
  for (const char* name : {"finger_flexion", "thumb_circumduction", "thumb_flexion"}) {
    const int a = axisOf(result, name);
    if (a < 0) continue;
    chart.lines.push_back(lineOf(result, a, [a](const ExerciseSample& s) { return s.phi[a]; }));
  }
  if (const int x = axisOf(result, "x"); x >= 0) {  // Eq. (5): y and z have the same value
    ChartLine arm{"x, y, z", "--ink", {1, 3}};
    arm.points = points(result, [x](const ExerciseSample& s) { return s.phi[x]; });
    chart.lines.push_back(std::move(arm));
  }
  return chart;
}

Chart onePanel(const ExerciseResult& result, const char* title, int height_px, const Value& value) {
  Chart chart = panel(result, title, height_px);
  ChartLine line;
  line.points = points(result, value);
  chart.lines.push_back(std::move(line));
  return chart;
}

/// Adds the exercise's share of an axis's effort as a thin line.
void addWall(Chart& chart, const ExerciseResult& result, const char* name) {
  const int a = axisOf(result, name);
  const double arm_m = a < 0 ? 0.0 : result.lever_arms_m[a];
  if (!(arm_m > 0.0)) return;
  ChartLine line{sentence("exercise.wall"), "--ink-2", {2, 2}, 1.2};
  line.points = points(result, [a, arm_m](const ExerciseSample& s) { return s.wall[a] / arm_m; });
  chart.lines.push_back(std::move(line));
  chart.y = {"", -kTipScale_n, 0.75 * kTipScale_n};
}

Chart glassPanel(const ExerciseResult& result) {
  Chart chart = onePanel(result, "exercise.glass", 54,
                         [](const ExerciseSample& s) { return 1e3 * s.glass_l; });
  ChartLine asked{sentence("exercise.asked", {{"ml", fmt::format("{:.0f}", 1e3 * result.asked_l)}}),
                  "--line-2",
                  {4, 3}};
  asked.points = {{0.0, 1e3 * result.asked_l}, {chart.x.to, 1e3 * result.asked_l}};
  chart.lines.push_back(std::move(asked));
  chart.y = {"", -2.0, 1.15e3 * std::max(result.asked_l, result.poured_l)};
  return chart;
}

std::vector<Chart> panels(const ExerciseResult& result) {
  std::vector<Chart> out;
  out.push_back(panel(result, "exercise.fingers", 100));
  addEfforts(out.back(), result, {"finger_flexion"});
  addWall(out.back(), result, "finger_flexion");
  out.push_back(panel(result, "exercise.thumb", 96));
  addEfforts(out.back(), result, {"thumb_flexion", "thumb_circumduction"});
  addWall(out.back(), result, "thumb_flexion");
  out.push_back(panel(result, "exercise.arm", 96));
  addEfforts(out.back(), result, {"x", "y", "z"});
  out.push_back(phiPanel(result));
  out.push_back(
      onePanel(result, "exercise.alpha", 44, [](const ExerciseSample& s) { return s.alpha; }));
  out.back().y = {"", -0.06, 1.12};
  out.push_back(onePanel(result, "exercise.flow", 54,
                         [](const ExerciseSample& s) { return 1e3 * s.flow_l_s; }));
  out.push_back(glassPanel(result));
  return out;
}

/// The paper's Fig. 7: efforts of fingers, thumb and arm, Φ, α, flow and fill over time, with the
/// phases shaded and labelled.
ChartPage exerciseFigure(const ExerciseResult& result) {
  ChartPage page;
  page.title = sentence("exercise.title");
  page.charts = panels(result);
  Chart& first = page.charts.front();
  for (std::size_t i = 0; i < first.marks.size(); ++i) {
    first.marks[i].label = sentence(kHeadings.at(i));
  }
  page.charts.back().names_x = true;
  return page;
}

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
  const auto out =
      prepareResults({named(options.json, "exercise.json"), named(options.charts, "exercise.html"),
                      named(options.record, "exercise.h5")},
                     !options.json.empty() && options.charts.empty());
  if (!out) return refuse(out.errors());
  ExercisePlan plan;
  plan.files = *files;
  plan.rig.engine = options.engine;
  plan.seed = options.seed;
  plan.record = out->record;
  const InterruptScope interrupts;
  auto result = runExercise(plan);
  if (!result) return refuse(result.errors());
  if (result->interrupted) return printInterrupted();
  if (auto done =
          writeResults(jsonText(resultJson(*result, options)), exerciseFigure(*result), *out);
      !done) {
    return refuse(done.errors());
  }
  print(*result);
  std::fputs(listed(*out).c_str(), stdout);
  return exitCodeOf(result->faulted, false);
}

}  // namespace wholehand
