#include "report/plot_scale.hpp"
#include "report/svg_plot.hpp"
#include "report/svg_text.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

using svg::kFontPx;
using svg::kLetter;
using svg::px;
using svg::segment;
using svg::words;

constexpr double kRow_px = 15.0;  ///< from one line of words to the next

/// Where the bars go [px].
struct Area {
  double left, right, top, bottom;
};

std::string drawBars(const HistogramPlot& plot, const Area& area, const PlotScale& y) {
  const auto bins = static_cast<double>(std::max<std::size_t>(1, plot.counts.size()));
  const double step = (area.right - area.left) / bins;
  std::string out;
  for (std::size_t i = 0; i < plot.counts.size(); ++i) {
    if (plot.counts[i] == 0) continue;
    const double at = y.px(static_cast<double>(plot.counts[i]));
    out += "<rect x=\"" + px(area.left + static_cast<double>(i) * step) + "\" y=\"" + px(at) +
           "\" width=\"" + px(std::max(0.5, step - 0.5)) + "\" height=\"" + px(area.bottom - at) +
           "\" fill=\"#6F675F\"/>";
  }
  return out + segment(area.left, area.bottom, area.right, area.bottom, kPlotInk, 1.0);
}

/// The percentiles, one below the other so that their names do not meet.
std::string drawMarks(const HistogramPlot& plot, const Area& area, const PlotScale& x, double row) {
  std::string out;
  for (const PlotMark& mark : plot.marks) {
    const double at = std::clamp(x.px(mark.x), area.left, area.right);
    const double width = static_cast<double>(mark.label.size()) * kLetter * kFontPx;
    const bool before = at + 5.0 + width > area.right;  // no room to the right
    out += segment(at, row - 8.0, at, area.bottom, kPlotInk, 1.0, "3 2.5");
    // A white halo keeps the word readable where it crosses a line or a bar.
    out += words(before ? at - 5.0 : at + 5.0, row, mark.label, before ? "end" : "start", kPlotInk,
                 650, kFontPx, " paint-order=\"stroke\" stroke=\"#FFFFFF\" stroke-width=\"4\"");
    row += kRow_px;
  }
  return out;
}

std::string drawNumbers(const HistogramPlot& plot, const Area& area, const PlotScale& x) {
  std::string out;
  const auto numbers = niceTicks(plot.x_min, plot.x_max, 6);
  for (const double v : numbers) {
    const bool last = v == numbers.back();
    const char* anchor = x.px(v) > area.right - 20.0 ? "end" : "middle";
    out +=
        words(x.px(v), plot.height_px - 5.0, tickText(v, numbers) + (last ? " " + plot.x_unit : ""),
              v == plot.x_min ? "start" : anchor, kPlotInk2);
  }
  return out;
}

}  // namespace

std::string histogramPlot(const HistogramPlot& plot) {
  const Area area = {34.0, plot.width_px - 2.0, plot.title.empty() ? 8.0 : 24.0,
                     plot.height_px - 20.0};
  std::uint64_t most = 1;
  for (const std::uint64_t c : plot.counts) most = std::max(most, c);
  // Room above the bars for the names of the marks; from 0.7, so that a bin that holds one tick is
  // seen.
  const double most_shown = static_cast<double>(most) * 8.0;
  const PlotScale x(plot.x_min, plot.x_max, area.left, area.right);
  const PlotScale y(0.7, most_shown, area.bottom, area.top, true);
  std::string out = svg::opening(plot.width_px, plot.height_px, plot.title);
  if (!plot.title.empty()) out += words(area.left, 11.0, plot.title, "start", kPlotInk, 650);
  for (const double v : decadeTicks(0.7, most_shown, 4)) {
    out += segment(area.left, y.px(v), area.right, y.px(v), kPlotRule, 0.7);
    out += words(area.left - 6.0, y.px(v) + 4.0, decadeText(v), "end", kPlotInk2);
  }
  out += drawBars(plot, area, y);
  double row = area.top + 4.0;
  if (std::isfinite(plot.deadline)) {  // below the title, above the percentiles: meets neither
    const double at = x.px(plot.deadline);
    out += segment(at, area.top - 8.0, at, area.bottom, kPlotBad, 2.0);
    out += words(at - 6.0, row, plot.deadline_label, "end", kPlotBad, 650);
    row += kRow_px;
  }
  out += drawMarks(plot, area, x, row);
  return out + drawNumbers(plot, area, x) + "</svg>\n";
}

}  // namespace wholehand
