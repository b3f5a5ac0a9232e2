#include "certification/certificate_chart.hpp"

#include "control/z_width.hpp"
#include "report/svg_plot.hpp"
#include "report/svg_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace wholehand {
namespace {

constexpr int kColumns = 3, kPoints = 25;
constexpr int kWidth_px = 380, kHeight_px = 240, kHeader_px = 62, kGap_px = 14;

/// Axes of one kind, by the first of them.
struct Group {
  std::size_t first = 0;
  std::string names;
};

std::vector<Group> groupsOf(const Certificate& certificate) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < certificate.axes.size(); ++i) {
    const AxisCase& c = certificate.axes[i].of;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
      return sameCase(certificate.axes[group.first].of, c);
    });
    if (same != groups.end()) {
      same->names += ", " + c.axis.name;
    } else {
      groups.push_back({i, c.axis.name});
    }
  }
  return groups;
}

std::string axisPlot(const AxisCertificate& a, const std::string& names) {
  const DeviceAxis& axis = a.of.axis;
  LinePlot plot;
  plot.title = fmt::format("{}: K_pm in {}/{}", names, axis.effortUnit(), axis.positionUnit());
  plot.width_px = kWidth_px;
  plot.height_px = kHeight_px;
  plot.left_px = 46;
  plot.right_px = 104;
  plot.x_unit = fmt::format("{}·s/{}", axis.effortUnit(), axis.positionUnit());
  PlotLine rigid{"rigid stop", kPlotInk2, "6 2.5", 1.5, 1.0, {}};
  PlotLine passive{"any person", "#00725C", "", 1.8, 1.0, {}};
  PlotLine walled{"in the wall", "#7A3E9D", "4 2", 1.8, 1.0, {}};
  for (const ZWidthPoint& point : zWidth(a.of, kPoints)) {
    rigid.points.push_back({point.damping, point.rigid});
    passive.points.push_back({point.damping, point.passive});
    if (!a.of.walls.empty()) walled.points.push_back({point.damping, point.walled});
  }
  const double end = rigid.points.back().x;
  const PlotLine quantisation{"quantisation",
                              "#8A5A00",
                              "1.5 2.5",
                              1.5,
                              1.0,
                              {{0.0, a.quantisationLimit()}, {end, a.quantisationLimit()}}};
  const double work = a.of.gains.k_dm > 0.0 ? a.of.gains.k_dm : 0.01 * end;
  const PlotLine working{a.passes ? "this axis" : "FAILS",
                         a.passes ? "#1F5FC4" : kPlotBad,
                         "",
                         5.0,
                         1.0,
                         {{0.0, a.of.gains.k_pm}, {work, a.of.gains.k_pm}}};
  plot.lines = {rigid, passive, quantisation, working};
  if (!walled.points.empty()) plot.lines.push_back(walled);
  plot.log_y = true;
  double lowest = a.of.gains.k_pm, highest = lowest;
  for (PlotLine& line : plot.lines) {
    for (PlotPoint& p : line.points) {
      if (!(p.y > 0.0)) p.y = LinePlot::kFromData;  // nothing is allowed: the line ends
      if (p.y < lowest) lowest = p.y;
      if (p.y > highest) highest = p.y;
    }
  }
  plot.y_min = 0.5 * lowest;
  plot.y_max = 2.0 * highest;
  return linePlot(plot);
}

}  // namespace

std::string certificateChart(const AdvisedCertificate& judged) {
  const std::vector<Group> groups = groupsOf(judged.certificate);
  const int columns = std::min<int>(kColumns, static_cast<int>(groups.size()));
  const int rows = (static_cast<int>(groups.size()) + columns - 1) / columns;
  const int width = std::max(2, columns) * (kWidth_px + kGap_px) + kGap_px;
  const int height = kHeader_px + rows * (kHeight_px + kGap_px);
  const std::string title =
      fmt::format("Z-width of {} with {}, {}{}: {}", judged.input.device.name,
                  judged.input.rendering.name, judged.input.hand,
                  judged.input.exercise.empty() ? "" : " and the walls of " + judged.input.exercise,
                  judged.certificate.certified ? "certified" : "NOT certified");
  std::string out = svg::opening(width, height, title) +
                    "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>";
  out += svg::words(kGap_px, 24, title, "start", kPlotInk, 700, 16.0);
  out += svg::words(
      kGap_px, 44,
      fmt::format("Largest stiffness (logarithmic) against the adaptive damping Φ K_dm at {:.4g} "
                  "Hz. Thick: where the axis works, Φ from 0 to 1; it must stay "
                  "below every line.",
                  1.0 / judged.certificate.period_s),
      "start", kPlotInk2);
  for (std::size_t i = 0; i < groups.size(); ++i) {
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    out +=
        fmt::format("<g transform=\"translate({} {})\">", kGap_px + column * (kWidth_px + kGap_px),
                    kHeader_px + row * (kHeight_px + kGap_px));
    out += axisPlot(judged.certificate.axes[groups[i].first], groups[i].names) + "</g>";
  }
  return out + "</svg>\n";
}

}  // namespace wholehand
