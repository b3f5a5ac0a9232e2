#include "report/svg_plot.hpp"

#include "report/plot_scale.hpp"
#include "report/svg_text.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace wholehand {
namespace {

constexpr double kTitlePx = 16.0, kHeadsPx = 34.0, kNumbersPx = 20.0;
using svg::attribute;
using svg::kFontPx;
using svg::kLetter;
using svg::opening;
using svg::px;
using svg::segment;
using svg::words;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void include(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
};

/// Where everything of a line plot goes.
struct Frame {
  double left, right, top, bottom;
  Range x, y;
};

Range dataRange(const LinePlot& plot, bool of_x) {
  Range range;
  const bool logarithmic = of_x ? plot.log_x : plot.log_y;
  for (const PlotLine& line : plot.lines) {
    for (const PlotPoint& p : line.points) {
      const double v = of_x ? p.x : p.y;
      if (std::isfinite(p.y) && std::isfinite(v) && (!logarithmic || v > 0.0)) range.include(v);
    }
  }
  return range.low > range.high ? Range{logarithmic ? 1.0 : 0.0, 1.0} : range;
}

Range yRange(const LinePlot& plot) {
  Range range = dataRange(plot, false);
  if (!plot.log_y) {
    if (plot.with_zero) range.include(0.0);
    const double missing = plot.least_y_span - (range.high - range.low);
    if (missing > 0.0) range.high += missing;
    const double span = range.high - range.low;
    const double margin = span > 0.0 ? 0.06 * span : 0.5;
    range = {range.low - margin, range.high + margin};
  } else if (range.low == range.high) {
    range = {range.low / 2.0, range.high * 2.0};
  }
  if (std::isfinite(plot.y_min)) range.low = plot.y_min;
  if (std::isfinite(plot.y_max)) range.high = plot.y_max;
  return range;
}

Frame frameOf(const LinePlot& plot) {
  Frame f{};
  f.left = plot.left_px;
  f.right = plot.width_px - plot.right_px;
  f.top = (plot.title.empty() ? 4.0 : kTitlePx) + (plot.mark_heads ? kHeadsPx : 0.0);
  f.bottom = plot.height_px - (plot.x_numbers ? kNumbersPx : 3.0);
  f.x = dataRange(plot, true);
  if (std::isfinite(plot.x_min)) f.x.low = plot.x_min;
  if (std::isfinite(plot.x_max)) f.x.high = plot.x_max;
  f.y = yRange(plot);
  return f;
}

std::string drawDots(const PlotLine& line, const PlotScale& x, const PlotScale& y) {
  std::string out = "<g" + attribute("fill", line.color) + ">";
  for (const PlotPoint& p : line.points) {
    if (!std::isfinite(p.y) || !std::isfinite(p.x)) continue;
    out += "<circle cx=\"" + px(x.px(p.x)) + "\" cy=\"" + px(y.px(p.y)) + "\" r=\"" +
           px(line.dot_px) + "\"/>";
  }
  return out + "</g>";
}

std::string drawLine(const PlotLine& line, const PlotScale& x, const PlotScale& y) {
  if (line.dot_px > 0.0) return drawDots(line, x, y);
  std::string path;
  bool pen_down = false;
  for (const PlotPoint& p : line.points) {
    if (!std::isfinite(p.y) || !std::isfinite(p.x)) {
      pen_down = false;
      continue;
    }
    path += (pen_down ? "L" : "M") + px(x.px(p.x)) + " " + px(y.px(p.y));
    pen_down = true;
  }
  if (path.empty()) return {};
  return "<path d=\"" + path + "\" fill=\"none\"" + attribute("stroke", line.color) +
         " stroke-width=\"" + px(line.width_px) + "\" stroke-linejoin=\"round\"" +
         (line.opacity < 1.0 ? " stroke-opacity=\"" + px(line.opacity) + "\"" : "") +
         (line.dash.empty() ? "" : attribute("stroke-dasharray", line.dash)) + "/>";
}

/// The names at the lines' ends, moved apart.
std::string drawNames(const LinePlot& plot, const Frame& f, const PlotScale& y) {
  std::vector<const PlotLine*> named;
  std::vector<double> wanted;
  for (const PlotLine& line : plot.lines) {
    const auto last = std::find_if(line.points.rbegin(), line.points.rend(),
                                   [](const PlotPoint& p) { return std::isfinite(p.y); });
    if (line.name.empty() || last == line.points.rend()) continue;
    named.push_back(&line);
    wanted.push_back(std::clamp(y.px(last->y), f.top, f.bottom));
  }
  const std::vector<double> places = declutter(wanted, 14.0, f.top + 4.0, f.bottom - 4.0);
  std::string out;
  for (std::size_t i = 0; i < named.size(); ++i) {
    const PlotLine& line = *named[i];
    out += segment(f.right + 3.0, places[i], f.right + 14.0, places[i], line.color,
                   std::max(1.8, line.width_px), line.dash.empty() ? "" : "4 2.5");
    out += words(f.right + 18.0, places[i] + 4.0, line.name, "start", line.color, 650);
  }
  return out;
}

/// Numbered heads above the plot; a word only where it has room before the next head.
std::string drawHeads(const LinePlot& plot, const Frame& f, const PlotScale& x) {
  std::vector<double> wanted;
  for (const PlotMark& mark : plot.marks) wanted.push_back(x.px(mark.x) + 10.0);
  const auto places = declutter(wanted, 23.0, f.left + 10.0, f.right - 10.0);
  const double y = 14.0;
  std::string out;
  for (std::size_t i = 0; i < plot.marks.size(); ++i) {
    const std::string& label = plot.marks[i].label;
    double room = plot.width_px - places[i];
    for (const double other : places) {
      if (other > places[i]) room = std::min(room, other - places[i] - 10.0);
    }
    out += "<circle cx=\"" + px(places[i]) + "\" cy=\"" + px(y) + "\" r=\"10\"" +
           attribute("fill", kPlotInk) + "/>" +
           words(places[i], y + 4.5, std::to_string(i + 1), "middle", "#FFFFFF", 700, 13.0);
    if (static_cast<double>(label.size()) * kLetter * 13.0 + 18.0 < room) {
      out += words(places[i] + 15.0, y + 4.5, label, "start", kPlotInk, 700, 13.0);
    }
  }
  return out;
}

std::string drawGrid(const LinePlot& plot, const Frame& f, const PlotScale& x, const PlotScale& y) {
  std::string out;
  const int rows = std::max(3, static_cast<int>((f.bottom - f.top) / 28.0));
  const auto ticks = !plot.y_ticks.empty() ? plot.y_ticks
                     : plot.log_y          ? logTicks(f.y.low, f.y.high, rows)
                                           : niceTicks(f.y.low, f.y.high, rows);
  for (const double v : ticks) {
    const bool zero = v == 0.0 && !plot.log_y;
    out +=
        segment(f.left, y.px(v), f.right, y.px(v), zero ? kPlotRule2 : kPlotRule, zero ? 1.0 : 0.7);
    out += words(f.left - 6.0, y.px(v) + 4.0,
                 plot.log_y ? logTickText(v, ticks) : tickText(v, ticks), "end", kPlotInk2);
  }
  if (!plot.x_numbers) return out;
  const int columns = std::max(2, static_cast<int>((f.right - f.left) / 70.0));
  const auto numbers =
      plot.log_x ? logTicks(f.x.low, f.x.high, columns) : niceTicks(f.x.low, f.x.high, columns);
  for (const double v : numbers) {
    const bool last = v == numbers.back();
    const std::string number = plot.log_x ? logTickText(v, numbers) : tickText(v, numbers);
    out += words(x.px(v), f.bottom + 16.0,
                 number + (last && !plot.x_unit.empty() ? " " + plot.x_unit : ""), "middle",
                 kPlotInk2);
  }
  return out;
}

}  // namespace

std::string linePlot(const LinePlot& plot) {
  const Frame f = frameOf(plot);
  const PlotScale x(f.x.low, f.x.high, f.left, f.right, plot.log_x);
  const PlotScale y(f.y.low, f.y.high, f.bottom, f.top, plot.log_y);
  std::string out = opening(plot.width_px, plot.height_px, plot.title);
  const auto shade = [&](double from, double to, const char* color) {
    const double a = std::clamp(x.px(from), f.left, f.right);
    const double b = std::clamp(x.px(to), f.left, f.right);
    out += "<rect x=\"" + px(a) + "\" y=\"" + px(f.top) + "\" width=\"" + px(b - a) +
           "\" height=\"" + px(f.bottom - f.top) + "\"" + attribute("fill", color) + "/>";
  };
  shade(f.x.low, f.x.high, "#FBF9F6");
  for (const PlotBand& band : plot.bands) shade(band.from, band.to, kPlotBand);
  for (const PlotMark& mark : plot.marks) {
    out += segment(x.px(mark.x), f.top, x.px(mark.x), f.bottom, kPlotRule2, 1.0, "2 3");
  }
  out += drawGrid(plot, f, x, y);
  if (!plot.title.empty()) {
    out += words(f.left, f.top - 5.0, plot.title, "start", kPlotInk, 650);
  }
  if (plot.mark_heads) out += drawHeads(plot, f, x);
  for (const PlotLine& line : plot.lines) out += drawLine(line, x, y);
  out += drawNames(plot, f, y);
  return out + "</svg>\n";
}

PlotPen axisPen(const std::string& axis_name, int index) {
  static const std::vector<std::pair<std::string, PlotPen>> kKnown = {
      {"x", {"#1F5FC4", "", "x"}},
      {"y", {"#B04A00", "6 2.5", "y"}},
      {"z", {"#00725C", "1.5 2.5", "z"}},
      {"roll", {"#1F5FC4", "", "roll"}},
      {"pitch", {"#B04A00", "6 2.5", "pitch"}},
      {"yaw", {"#00725C", "1.5 2.5", "yaw"}},
      {"finger_flexion", {"#8A5A00", "", "fingers"}},
      {"thumb_circumduction", {"#8E0B4E", "1.5 2.5", "turn"}},
      {"thumb_flexion", {"#006A94", "6 2.5", "thumb"}}};
  for (const auto& [name, pen] : kKnown) {
    if (name == axis_name) return pen;
  }
  static constexpr std::array<const char*, 6> kColors = {"#1F5FC4", "#B04A00", "#00725C",
                                                         "#8A5A00", "#8E0B4E", "#006A94"};
  static constexpr std::array<const char*, 4> kDashes = {"", "6 2.5", "1.5 2.5", "8 2 1.5 2"};
  const auto i = static_cast<std::size_t>(std::max(index, 0));
  return {kColors[i % kColors.size()], kDashes[(i + i / kColors.size()) % kDashes.size()],
          axis_name};
}

}  // namespace wholehand
