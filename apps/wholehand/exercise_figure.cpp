#include "exercise_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>

namespace wholehand {
namespace {

constexpr double kTipScale_n = 7.5;  // makes fingers and thumb comparable
constexpr double kStep_s = 0.02;     // line step; each one shows its minimum and maximum
constexpr std::array<const char*, 4> kHeadings = {"exercise.bumps", "exercise.approaches",
                                                  "exercise.squeezes", "exercise.letsGo"};

using Value = std::function<double(const ExerciseSample&)>;

/// Reduces every interval of kStep_s to its extremes, in order: no spike is lost.
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

/// Efforts sent to these axes: N at the tip if there is one; circumduction, which has none, in 0.1
/// N·m for visibility.
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
  if (const int x = axisOf(result, "x"); x >= 0) {  // Eq. (5): y and z have the same
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

/// The exercise's share of an axis's effort, as a thin line.
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

}  // namespace

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

}  // namespace wholehand
