#include "exercise_figure.hpp"

#include "report/svg_plot.hpp"
#include "report/svg_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace wholehand {
namespace {

constexpr int kWidth_px = 900, kLeft_px = 52, kRight_px = 84;
constexpr int kHeads_px = 34, kTitle_px = 16, kNumbers_px = 20;
constexpr int kGap_px = 6;
constexpr double kTipScale_n = 7.5;  // fingers and thumb can be compared
constexpr double kStep_s = 0.02;     // of the lines; in between, the largest and the smallest
constexpr std::array<const char*, 4> kHeadings = {"bumps into it", "approaches", "squeezes",
                                                  "lets go, retrieves"};

using Value = std::function<double(const ExerciseSample&)>;

/// Every stretch of kStep_s becomes its extremes, in their order: no spike is lost.
std::vector<PlotPoint> points(const ExerciseResult& result, const Value& value) {
  std::vector<PlotPoint> out;
  const auto& samples = result.samples;
  for (std::size_t i = 0; i < samples.size();) {
    PlotPoint low{samples[i].time_s, value(samples[i])}, high = low;
    const double end_s = samples[i].time_s + kStep_s;
    for (; i < samples.size() && samples[i].time_s < end_s; ++i) {
      const PlotPoint p{samples[i].time_s, value(samples[i])};
      if (p.y < low.y) low = p;
      if (p.y > high.y) high = p;
    }
    out.push_back(low.x < high.x ? low : high);
    if (low.x != high.x) out.push_back(low.x < high.x ? high : low);
  }
  return out;
}

int axisOf(const ExerciseResult& result, const std::string& name) {
  const auto& names = result.axis_names;
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

PlotLine lineOf(const ExerciseResult& result, int axis, const Value& value) {
  const PlotPen pen = axisPen(result.axis_names[static_cast<std::size_t>(axis)], axis);
  PlotLine line;
  line.name = pen.word;
  line.color = pen.color;
  line.dash = pen.dash;
  line.width_px = pen.dash.empty() ? 1.7 : 1.5;
  line.points = points(result, value);
  return line;
}

LinePlot panel(const ExerciseResult& result, std::string title, int height_px) {
  LinePlot plot;
  plot.title = std::move(title);
  plot.width_px = kWidth_px;
  plot.height_px = height_px + kTitle_px + 3;
  plot.left_px = kLeft_px;
  plot.right_px = kRight_px;
  plot.x_min = 0.0;
  plot.x_max = result.samples.empty() ? 1.0 : result.samples.back().time_s;
  plot.x_numbers = false;
  plot.x_unit = "s";
  for (const ExercisePhase& phase : result.phases) {
    plot.bands.push_back({phase.start_s, phase.end_s});
    plot.marks.push_back({phase.start_s, kHeadings.at(plot.marks.size())});
  }
  return plot;
}

/// Efforts sent to these axes: N at the tip where there is one; circumduction, which has none worth
/// the name, in 0.1 N·m so that it can be seen.
void addEfforts(LinePlot& plot, const ExerciseResult& result,
                const std::vector<const char*>& names) {
  for (const char* name : names) {
    const int a = axisOf(result, name);
    if (a < 0) continue;
    const double arm_m = result.lever_arms_m[static_cast<std::size_t>(a)];
    const bool turn = std::string(name) == "thumb_circumduction";
    const double unit = turn ? 0.1 : arm_m > 0.0 ? arm_m : 1.0;
    plot.lines.push_back(
        lineOf(result, a, [a, unit](const ExerciseSample& s) { return s.sent[a] / unit; }));
  }
}

LinePlot phiPanel(const ExerciseResult& result) {
  LinePlot plot = panel(result, "Adaptive damping φ", 74);
  plot.y_min = -0.04;
  plot.y_max = 1.12;
  for (const char* name : {"finger_flexion", "thumb_circumduction", "thumb_flexion"}) {
    const int a = axisOf(result, name);
    if (a < 0) continue;
    plot.lines.push_back(lineOf(result, a, [a](const ExerciseSample& s) { return s.phi[a]; }));
  }
  if (const int x = axisOf(result, "x"); x >= 0) {  // Eq. (5): y and z have the same
    PlotLine arm = lineOf(result, x, [x](const ExerciseSample& s) { return s.phi[x]; });
    arm.name = "x, y, z";
    arm.color = kPlotInk;
    arm.dash = "1 3";
    plot.lines.push_back(std::move(arm));
  }
  return plot;
}

LinePlot onePanel(const ExerciseResult& result, const char* title, int height_px,
                  const Value& value) {
  LinePlot plot = panel(result, title, height_px);
  PlotLine line;
  line.width_px = 1.7;
  line.points = points(result, value);
  plot.lines.push_back(std::move(line));
  return plot;
}

/// What of an axis's effort is the exercise's, thin beside the whole.
void addWall(LinePlot& plot, const ExerciseResult& result, const char* name) {
  const int a = axisOf(result, name);
  const double arm_m = a < 0 ? 0.0 : result.lever_arms_m[static_cast<std::size_t>(a)];
  if (!(arm_m > 0.0)) return;
  PlotLine line =
      lineOf(result, a, [a, arm_m](const ExerciseSample& s) { return s.wall[a] / arm_m; });
  line.name = "wall";
  line.color = kPlotInk2;
  line.dash = "2 2";
  line.width_px = 1.2;
  plot.lines.push_back(std::move(line));
  plot.y_min = -kTipScale_n;
  plot.y_max = 0.75 * kTipScale_n;
}

std::vector<LinePlot> panels(const ExerciseResult& result) {
  std::vector<LinePlot> out;
  out.push_back(panel(result, "Fingers, N at the tips", 96));
  addEfforts(out.back(), result, {"finger_flexion"});
  addWall(out.back(), result, "finger_flexion");
  out.push_back(panel(result, "Thumb, N at the tip (turn in 0.1 N·m)", 96));
  addEfforts(out.back(), result, {"thumb_flexion", "thumb_circumduction"});
  addWall(out.back(), result, "thumb_flexion");
  out.push_back(panel(result, "Arm, N", 96));
  addEfforts(out.back(), result, {"x", "y", "z"});
  out.push_back(phiPanel(result));
  out.push_back(onePanel(result, "Transition α of the exercise's haptics", 44,
                         [](const ExerciseSample& s) { return s.alpha; }));
  out.back().y_min = -0.06;
  out.back().y_max = 1.12;
  out.push_back(
      onePanel(result, "Flow, ml/s", 54, [](const ExerciseSample& s) { return 1e3 * s.flow_l_s; }));
  out.push_back(onePanel(result, "In the glass, ml", 54,
                         [](const ExerciseSample& s) { return 1e3 * s.glass_l; }));
  PlotLine asked;
  asked.name = fmt::format("asked {:.0f}", 1e3 * result.asked_l);
  asked.color = kPlotRule2;
  asked.dash = "4 3";
  asked.points = {{0.0, 1e3 * result.asked_l}, {out.back().x_max, 1e3 * result.asked_l}};
  out.back().lines.push_back(std::move(asked));
  out.back().y_min = -2.0;
  out.back().y_max = 1.15e3 * std::max(result.asked_l, result.poured_l);
  return out;
}

}  // namespace

std::string exerciseFigure(const ExerciseResult& result) {
  std::vector<LinePlot> all = panels(result);
  all.front().mark_heads = !result.phases.empty();
  all.back().x_numbers = true;
  if (all.front().mark_heads) all.front().height_px += kHeads_px;
  all.back().height_px += kNumbers_px - 3;
  int height_px = 0;
  std::string inner;
  for (const LinePlot& plot : all) {
    // One picture inside another: placed by its own x and y.
    inner += fmt::format("<svg y=\"{}\"{}", height_px, linePlot(plot).substr(4));
    height_px += plot.height_px + kGap_px;
  }
  return svg::opening(kWidth_px, height_px, "What the hand felt at the cocktail bar") +
         "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>" + inner + "</svg>\n";
}

}  // namespace wholehand
