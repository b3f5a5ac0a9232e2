#include "impedance_chart.hpp"

#include "impedance_text.hpp"
#include "report/svg_plot.hpp"
#include "report/svg_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

using Complex = std::complex<double>;

constexpr int kColumns = 3;
constexpr int kWidth_px = 420, kMagnitude_px = 220, kPhase_px = 130, kHeader_px = 86, kGap_px = 18;
constexpr int kCell_px = kMagnitude_px + kPhase_px;
constexpr double kDot_px = 2.2;
constexpr std::size_t kDotEvery = 2;
constexpr const char* kDashed = "5 3";

const char* colorOf(ContactCase contact) {
  if (contact == ContactCase::kFree) return "#1F5FC4";
  return contact == ContactCase::kRigid ? "#8E0B4E" : "#00725C";
}

double decibel(const Complex& z) {
  return 20.0 * std::log10(std::abs(z));
}
double degrees(const Complex& z) {
  return std::arg(z) * 180.0 / std::numbers::pi;
}

/// A prediction as a line and its measurement as dots.
void addCurve(const ImpedanceCurve& curve, double (*value)(const Complex&), LinePlot& plot) {
  PlotLine line;
  line.color = colorOf(curve.contact);
  line.dash = curve.phi > 0.0 ? kDashed : "";
  line.width_px = 1.4;
  PlotLine dots = line;
  dots.dot_px = curve.phi > 0.0 ? 0.7 * kDot_px : kDot_px;
  for (const auto& [frequency_hz, z] : curve.line) {
    line.points.push_back({frequency_hz, value(z)});
  }
  for (std::size_t i = 0; i < curve.points.size() && curve.not_measured.empty(); i += kDotEvery) {
    const ImpedancePoint& point = curve.points[i];
    dots.points.push_back({point.frequency_hz, value(point.measured.felt)});
  }
  plot.lines.push_back(std::move(line));
  plot.lines.push_back(std::move(dots));
}

LinePlot emptyPlot(int height_px) {
  LinePlot plot;
  plot.width_px = kWidth_px;
  plot.height_px = height_px;
  plot.left_px = 40;
  plot.right_px = 14;
  plot.log_x = true;
  plot.with_zero = false;
  plot.bands = {{kComparedFrom_hz, kComparedTo_hz}};
  return plot;
}

std::string axisPlots(const AxisImpedance& axis) {
  LinePlot magnitude = emptyPlot(kMagnitude_px), phase = emptyPlot(kPhase_px);
  magnitude.title = fmt::format("{}: |Z| in dB of 1 {}", axis.axis.name, impedanceUnit(axis.axis));
  magnitude.x_numbers = false;
  phase.title = "phase in degrees";
  phase.x_unit = "Hz";
  phase.y_ticks = {-90.0, 0.0, 90.0};
  phase.y_min = -105.0;
  phase.y_max = 105.0;
  for (const ImpedanceCurve& curve : axis.curves) {
    addCurve(curve, decibel, magnitude);
    addCurve(curve, degrees, phase);
  }
  for (const PlotLine& line : phase.lines) {
    for (const PlotPoint& p : line.points) {
      phase.y_min = std::min(phase.y_min, p.y - 5.0);
      phase.y_max = std::max(phase.y_max, p.y + 5.0);
    }
  }
  return linePlot(magnitude) + fmt::format("<g transform=\"translate(0 {})\">", kMagnitude_px) +
         linePlot(phase) + "</g>";
}

std::string legend(const ImpedanceReport& report) {
  constexpr double kY_px = 66.0, kSample_px = 26.0;
  double x = kGap_px;
  std::string out;
  const auto entry = [&](const std::string& sample, const std::string& word) {
    out += sample + svg::words(x + kSample_px + 6.0, kY_px + 4.0, word, "start", kPlotInk2);
    x += kSample_px + 28.0 + 0.52 * svg::kFontPx * static_cast<double>(word.size());
  };
  const auto line = [&](const char* color, const char* dash) {
    return svg::segment(x, kY_px, x + kSample_px, kY_px, color, 2.0, dash);
  };
  entry(line(colorOf(ContactCase::kFree), ""), "free");
  entry(line(colorOf(ContactCase::kObject), ""),
        fmt::format("spring of {:.4g} N/m at the hand", report.contact_stiffness_n_m));
  entry(line(colorOf(ContactCase::kRigid), ""), "rigid stop");
  entry(line(kPlotInk2, ""), "Φ = 0: no adaptive damping");
  entry(line(kPlotInk2, kDashed), "Φ = 1: all of it");
  const auto dot = [&](double radius, double share) {
    return "<circle cx=\"" + svg::px(x + share * kSample_px) + "\" cy=\"" + svg::px(kY_px) +
           "\" r=\"" + svg::px(radius) + "\"" + svg::attribute("fill", kPlotInk2) + "/>";
  };
  entry(dot(kDot_px, 0.35) + dot(0.7 * kDot_px, 0.75), "measured (lines: predicted)");
  return out;
}

}  // namespace

std::string impedanceChart(const ImpedanceReport& report) {
  const int count = static_cast<int>(report.axes.size());
  const int columns = std::min(kColumns, count), rows = (count + columns - 1) / columns;
  // Wide enough for the legend, however few axes there are.
  const int width = std::max(columns * (kWidth_px + kGap_px) + kGap_px, 900);
  const int height = kHeader_px + rows * (kCell_px + kGap_px);
  const std::string title = fmt::format("What the person feels: {} with {} and {}", report.device,
                                        report.rendering, report.hand);
  std::string out = svg::opening(width, height, title) +
                    "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>";
  out += svg::words(kGap_px, 24, title, "start", kPlotInk, 700, 16.0);
  out += svg::words(
      kGap_px, 44,
      fmt::format(
          "Impedance Z, effort over velocity, at {:.4g} Hz: rising 20 dB a decade with +90° "
          "like a mass, falling with −90° like a spring, level at 0° like a damper. Shaded: "
          "where prediction and measurement are compared.",
          1.0 / report.period_s),
      "start", kPlotInk2);
  out += legend(report);
  for (int i = 0; i < count; ++i) {
    out += fmt::format("<g transform=\"translate({} {})\">",
                       kGap_px + i % columns * (kWidth_px + kGap_px),
                       kHeader_px + i / columns * (kCell_px + kGap_px));
    out += axisPlots(report.axes[static_cast<std::size_t>(i)]) + "</g>";
  }
  return out + "</svg>\n";
}

}  // namespace wholehand
