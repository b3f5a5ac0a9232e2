#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

/// Small plots as SVG text, for the report page and for experiments: no dependency, no network,
/// complete files by themselves. Every text is escaped. Colours, dashes and sizes are those of the
/// report's design (black on white, each series told apart by its dash as well).
namespace wholehand {

struct PlotPoint {
  double x = 0.0, y = 0.0;
};

struct PlotLine {
  std::string name;  ///< written at the line's end; empty: not written
  std::string color = "#1B1714";
  std::string dash;  ///< SVG stroke-dasharray, empty for solid
  double width_px = 1.5;
  double opacity = 1.0;
  std::vector<PlotPoint> points;  ///< in the order of drawing; NaN breaks the line
  double dot_px = 0.0;            ///< > 0: a disc of this radius at every point, and no line
};

/// A vertical line with a word above the plot.
struct PlotMark {
  double x = 0.0;
  std::string label;
};

/// A shaded stretch.
struct PlotBand {
  double from = 0.0, to = 0.0;
};

struct LinePlot {
  static constexpr double kFromData = std::numeric_limits<double>::quiet_NaN();

  std::string title;
  int width_px = 657, height_px = 150;  ///< of the whole picture
  int left_px = 40, right_px = 76;      ///< room for the numbers, room for the names
  double x_min = kFromData, x_max = kFromData;
  double y_min = kFromData, y_max = kFromData;
  bool with_zero = true;             ///< the y range holds 0 (linear only)
  double least_y_span = 0.0;         ///< a still signal is not blown up beyond this
  std::vector<double> y_ticks = {};  ///< where the numbers stand; empty: at round ones
  bool log_x = false, log_y = false;
  bool x_numbers = true;  ///< numbers below the plot
  std::string x_unit;     ///< after the last number
  std::vector<PlotLine> lines;
  std::vector<PlotBand> bands;
  std::vector<PlotMark> marks;
  bool mark_heads = false;  ///< numbered heads with labels above the plot
};
[[nodiscard]] std::string linePlot(const LinePlot& plot);

/// Counts on a logarithmic scale over evenly wide bins.
struct HistogramPlot {
  std::string title;
  int width_px = 356, height_px = 190;
  double x_min = 0.0, x_max = 1.0;  ///< ends of the first and of the last bin
  std::vector<std::uint64_t> counts;
  std::string x_unit;
  std::vector<PlotMark> marks;            ///< percentiles: dashed, named
  double deadline = LinePlot::kFromData;  ///< a red line there, when finite
  std::string deadline_label;
};
[[nodiscard]] std::string histogramPlot(const HistogramPlot& plot);

/// Ink of the report's design.
inline constexpr const char* kPlotInk = "#1B1714";
inline constexpr const char* kPlotInk2 = "#554D46";
inline constexpr const char* kPlotRule = "#CFC8BD";
inline constexpr const char* kPlotRule2 = "#8B8278";
inline constexpr const char* kPlotBand = "#F3EFE8";
inline constexpr const char* kPlotBad = "#A1141A";
inline constexpr const char* kPlotFont =
    "'Atkinson Hyperlegible Next','Atkinson Hyperlegible',system-ui,'Segoe UI',Roboto,"
    "'Helvetica Neue',Arial,'Noto Sans','DejaVu Sans',sans-serif";

/// The pen of a device axis by its name (x, y, z, fingers, thumb ...), others by their number.
struct PlotPen {
  std::string color, dash, word;
};
[[nodiscard]] PlotPen axisPen(const std::string& axis_name, int index);

}  // namespace wholehand
