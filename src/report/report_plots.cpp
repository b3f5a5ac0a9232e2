#include "report/report_plots.hpp"

#include "report/html_text.hpp"
#include "report/svg_plot.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

constexpr std::size_t kMostNumbered = 8;
constexpr int kWidth_px = 657, kTitle_px = 16, kHeads_px = 34, kNumbers_px = 20;

/// A plot and the share of the height it gets.
struct Panel {
  LinePlot plot;
  double weight = 1.0;
};

Panel panel(const ReportData& data, std::string title, double weight) {
  Panel p;
  p.weight = weight;
  p.plot.title = std::move(title);
  p.plot.width_px = kWidth_px;
  p.plot.x_min = data.from_s;
  p.plot.x_max = data.to_s;
  for (const Touch& t : data.touches) p.plot.bands.push_back({t.from_s, t.to_s});
  for (const Touch& t : numberedTouches(data)) {
    p.plot.marks.push_back({t.from_s, data.bodies[static_cast<std::size_t>(t.body)].name});
  }
  return p;
}

PlotLine axisLine(const ReportAxis& axis, int index, const std::vector<PlotPoint>& points) {
  const PlotPen pen = axisPen(axis.name, index);
  PlotLine line;
  line.name = pen.word;
  line.color = pen.color;
  line.dash = pen.dash;
  line.width_px = pen.dash.empty() ? 1.7 : 1.5;
  line.points = points;
  return line;
}

PlotLine plainLine(const std::vector<PlotPoint>& points) {
  PlotLine line;
  line.points = points;
  line.width_px = 1.4;
  return line;
}

/// Puts the panels under one another; the first carries the numbered heads, the last the time.
std::string stack(std::vector<Panel> panels, int height_px) {
  if (panels.empty()) return {};
  double weights = 0.0;
  for (const Panel& p : panels) weights += p.weight;
  const bool heads = !panels.front().plot.marks.empty();
  const double fixed =
      (heads ? kHeads_px : 0) + kNumbers_px + static_cast<double>(panels.size()) * (kTitle_px + 3);
  std::string out;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    LinePlot& plot = panels[i].plot;
    const bool last = i + 1 == panels.size();
    const double room = std::max(40.0, (height_px - fixed) * panels[i].weight / weights);
    plot.mark_heads = heads && i == 0;
    plot.x_numbers = last;
    plot.x_unit = "s";
    plot.height_px = static_cast<int>(room) + kTitle_px + (plot.mark_heads ? kHeads_px : 0) +
                     (last ? kNumbers_px : 3);
    out += linePlot(plot);
  }
  return out;
}

bool hasRole(const ReportData& data, AxisRole role) {
  return std::any_of(data.axes.begin(), data.axes.end(),
                     [role](const ReportAxis& a) { return a.role == role; });
}

/// Efforts of one role. Where some axes are told in N at the tip and others in N·m, the latter are
/// drawn in 0.1 N·m so that both can be seen.
Panel effortPanel(const ReportData& data, AxisRole role, const std::string& title, double weight) {
  bool newtons = false;
  std::string turned;
  for (const ReportAxis& a : data.axes)
    newtons = newtons || (a.role == role && a.effort_unit == "N");
  Panel p = panel(data, "", weight);
  p.plot.least_y_span = newtons ? 1.0 : 0.1;
  for (std::size_t i = 0; i < data.axes.size(); ++i) {
    const ReportAxis& axis = data.axes[i];
    if (axis.role != role) continue;
    PlotLine line = axisLine(axis, static_cast<int>(i), axis.effort);
    if (newtons && axis.effort_unit != "N") {
      turned += (turned.empty() ? "" : ", ") + line.name;
      for (PlotPoint& point : line.points) point.y *= 10.0;
    }
    p.plot.lines.push_back(std::move(line));
  }
  const bool tips = role == AxisRole::kHand;
  p.plot.title = title + (newtons ? (tips ? ", N at the tips" : ", N") : ", N·m") +
                 (turned.empty() ? "" : " (" + turned + " in 0.1 N·m)");
  return p;
}

Panel positionPanel(const ReportData& data, AxisRole role, const std::string& title,
                    double weight) {
  Panel p = panel(data, title, weight);
  p.plot.with_zero = false;
  p.plot.least_y_span = 1.0;
  // The avatar first, wide and pale: where the two part, the device's line leaves it.
  for (const bool device : {false, true}) {
    for (std::size_t i = 0; i < data.axes.size(); ++i) {
      const ReportAxis& axis = data.axes[i];
      if (axis.role != role) continue;
      PlotLine line = axisLine(axis, static_cast<int>(i), device ? axis.device : axis.avatar);
      if (!device) {
        line.name.clear();
        line.dash.clear();
        line.width_px = 5.0;
        line.opacity = 0.3;
      }
      p.plot.lines.push_back(std::move(line));
    }
  }
  return p;
}

/// True when two axes had the very same Φ all along.
bool samePhi(const ReportAxis& a, const ReportAxis& b) {
  return std::equal(a.phi.begin(), a.phi.end(), b.phi.begin(), b.phi.end(),
                    [](const PlotPoint& p, const PlotPoint& q) { return p.y == q.y; });
}

Panel dampingPanel(const ReportData& data) {
  Panel p = panel(data, "Adaptive damping Φ", 0.75);
  p.plot.y_min = -0.04;
  p.plot.y_max = 1.12;
  const bool hand = hasRole(data, AxisRole::kHand);
  // By Eq. (5) arm and wrist share the hand's largest Φ: one dotted line on top stands for all of
  // them that are equal.
  const ReportAxis* shared = nullptr;
  for (std::size_t i = 0; i < data.axes.size(); ++i) {
    const ReportAxis& axis = data.axes[i];
    if (hand && axis.role != AxisRole::kHand) {
      if (shared == nullptr) shared = &axis;
      if (samePhi(*shared, axis)) continue;
    }
    p.plot.lines.push_back(axisLine(axis, static_cast<int>(i), axis.phi));
  }
  if (shared != nullptr) {
    PlotLine line = plainLine(shared->phi);
    line.name = "arm";
    line.dash = "1.5 2.5";
    p.plot.lines.push_back(std::move(line));
  }
  return p;
}

}  // namespace

std::vector<Touch> numberedTouches(const ReportData& data) {
  std::vector<Touch> touches = data.touches;
  // A long touch is worth telling, and so is a short, hard one: 10 N count like a second.
  const auto worth = [](const Touch& t) { return t.to_s - t.from_s + 0.1 * t.largest_force_n; };
  std::stable_sort(touches.begin(), touches.end(),
                   [&worth](const Touch& a, const Touch& b) { return worth(a) > worth(b); });
  if (touches.size() > kMostNumbered) touches.resize(kMostNumbered);
  std::stable_sort(touches.begin(), touches.end(),
                   [](const Touch& a, const Touch& b) { return a.from_s < b.from_s; });
  return touches;
}

std::string effortPlots(const ReportData& data, int height_px) {
  std::vector<Panel> panels;
  if (hasRole(data, AxisRole::kHand)) {
    panels.push_back(effortPanel(data, AxisRole::kHand, "Hand effort", 1.45));
  }
  if (hasRole(data, AxisRole::kArm)) {
    panels.push_back(effortPanel(data, AxisRole::kArm, "Arm effort", 1.0));
  }
  if (hasRole(data, AxisRole::kWrist)) {
    panels.push_back(effortPanel(data, AxisRole::kWrist, "Wrist effort", 0.8));
  }
  panels.push_back(dampingPanel(data));
  Panel force = panel(data, "Contact forces, N in all", 0.75);
  force.plot.least_y_span = 1.0;
  force.plot.lines.push_back(plainLine(data.contact_force_n));
  panels.push_back(std::move(force));
  return stack(std::move(panels), height_px);
}

std::string movementPlots(const ReportData& data, int height_px) {
  std::vector<Panel> panels;
  const auto add = [&](AxisRole role, const char* title) {
    if (hasRole(data, role)) panels.push_back(positionPanel(data, role, title, 1.2));
  };
  add(AxisRole::kHand, "Hand position, degrees");
  add(AxisRole::kArm, "Arm position, mm");
  add(AxisRole::kWrist, "Wrist position, degrees");
  Panel palm = panel(data, "Palm to the nearest object, mm", 0.7);
  palm.plot.lines.push_back(plainLine(data.palm_distance_mm));
  palm.plot.least_y_span = 10.0;
  panels.push_back(std::move(palm));
  Panel count = panel(data, "Contact points", 0.5);
  count.plot.lines.push_back(plainLine(data.contact_count));
  count.plot.least_y_span = 4.0;
  panels.push_back(std::move(count));
  return stack(std::move(panels), height_px);
}

std::string timingPlot(const ReportData& data) {
  const double period_us = data.meta.period_s * 1e6;
  const Percentiles& times = data.cpu_time ? data.summary.cpu : data.summary.wall;
  // One bin is 1 % of the period. As far as the slowest tick, but the deadline always shows.
  const double slowest = times.max_ns * 1e-3 / period_us * 100.0 + 2.0;
  const auto last =
      std::min(static_cast<std::size_t>(std::max(110.0, slowest)), data.durations.size());
  HistogramPlot plot;
  plot.title = "";
  plot.counts.assign(data.durations.begin(),
                     data.durations.begin() + static_cast<std::ptrdiff_t>(last));
  plot.x_max = static_cast<double>(last) / 100.0 * period_us;
  plot.x_unit = "µs";
  const auto mark = [](const char* name, double ns) {
    return PlotMark{ns * 1e-3, std::string(name) + " " + formatNumber(ns * 1e-3, 0) + " µs"};
  };
  plot.marks = {mark("p50", times.p50_ns), mark("p99", times.p99_ns), mark("p99.9", times.p999_ns)};
  plot.deadline = period_us;
  plot.deadline_label =
      "deadline " + formatNumber(data.meta.period_s * 1e3, data.meta.period_s < 0.9e-3 ? 2 : 0) +
      " ms";
  return histogramPlot(plot);
}

}  // namespace wholehand
