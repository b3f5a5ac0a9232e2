#include "impedance_chart.hpp"

#include "impedance_text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

using Complex = std::complex<double>;

constexpr double kDot_px = 4.0;
constexpr std::size_t kDotEvery = 2;
const std::vector<int> kDashed_px = {5, 3};

const char* colorOf(ContactCase contact) {
  if (contact == ContactCase::kFree) return "--ax-x";
  return contact == ContactCase::kRigid ? "--ax-c" : "--ax-z";
}

double decibel(const Complex& z) {
  return 20.0 * std::log10(std::abs(z));
}
double degrees(const Complex& z) {
  return std::arg(z) * 180.0 / std::numbers::pi;
}

/// A prediction as a line and its measurement as dots.
void addCurve(const ImpedanceCurve& curve, double (*value)(const Complex&), Chart& chart) {
  ChartLine line{nullptr, colorOf(curve.contact), {}, 1.4};
  if (curve.phi > 0.0) line.dash_px = kDashed_px;
  ChartLine dots = line;
  dots.dot_px = curve.phi > 0.0 ? 0.7 * kDot_px : kDot_px;
  for (const auto& [frequency_hz, z] : curve.line) {
    line.points.push_back({frequency_hz, value(z)});
  }
  for (std::size_t i = 0; i < curve.points.size() && curve.not_measured.empty(); i += kDotEvery) {
    const ImpedancePoint& point = curve.points[i];
    dots.points.push_back({point.frequency_hz, value(point.measured.felt)});
  }
  chart.lines.push_back(std::move(line));
  chart.lines.push_back(std::move(dots));
}

/// Magnitude or phase of one axis.
Chart bodeChart(const AxisImpedance& axis, double (*value)(const Complex&), int height_px) {
  Chart chart;
  chart.height_px = height_px;
  chart.x.logarithmic = true;
  chart.bands = {{kComparedFrom_hz, kComparedTo_hz}};
  for (const ImpedanceCurve& curve : axis.curves) addCurve(curve, value, chart);
  return chart;
}

Chart magnitudeChart(const AxisImpedance& axis) {
  Chart magnitude = bodeChart(axis, decibel, 150);
  magnitude.title = sentence("impedance.magnitude",
                             {{"axes", axis.axis.name}, {"unit", impedanceUnit(axis.axis)}});
  magnitude.names_x = false;
  return magnitude;
}

Chart phaseChart(const AxisImpedance& axis) {
  Chart phase = bodeChart(axis, degrees, 76);
  phase.below_previous = true;
  phase.title = sentence("impedance.phase");
  phase.x.unit = "Hz";
  phase.y.numbers_at = {-90.0, 0.0, 90.0};
  phase.y.from = -105.0;
  phase.y.to = 105.0;
  for (const ChartLine& line : phase.lines) {
    for (const auto& [frequency_hz, angle_deg] : line.points) {
      phase.y.from = std::min(phase.y.from, angle_deg - 5.0);
      phase.y.to = std::max(phase.y.to, angle_deg + 5.0);
    }
  }
  return phase;
}

std::vector<ChartLine> legend(const ImpedanceReport& report) {
  const std::string stiffness = fmt::format("{:.4g}", report.contact_stiffness_n_m);
  ChartLine dots{sentence("impedance.measured"), "--ink-2"};
  dots.dot_px = kDot_px;
  return {{sentence("impedance.free"), colorOf(ContactCase::kFree)},
          {sentence("impedance.spring", {{"stiffness", stiffness}}), colorOf(ContactCase::kObject)},
          {sentence("impedance.rigid"), colorOf(ContactCase::kRigid)},
          {sentence("impedance.undamped"), "--ink-2"},
          {sentence("impedance.damped"), "--ink-2", kDashed_px},
          dots};
}

}  // namespace

ChartPage impedanceChart(const ImpedanceReport& report) {
  ChartPage page;
  page.title =
      sentence("impedance.title",
               {{"device", report.device}, {"rendering", report.rendering}, {"hand", report.hand}});
  page.notes = {
      sentence("impedance.note", {{"rate", fmt::format("{:.4g}", 1.0 / report.period_s)}})};
  page.legend = legend(report);
  page.columns = 2;
  for (const AxisImpedance& axis : report.axes) {
    page.charts.push_back(magnitudeChart(axis));
    page.charts.push_back(phaseChart(axis));
  }
  return page;
}

}  // namespace wholehand
