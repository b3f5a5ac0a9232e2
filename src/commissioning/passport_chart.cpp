#include "commissioning/passport_chart.hpp"

#include "report/svg_plot.hpp"
#include "report/svg_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace wholehand {
namespace {

constexpr double kMost = 2.0;  // shares of the file's number from 0 to this are drawn
constexpr int kLeft_px = 250, kScale_px = 400, kRight_px = 290, kTop_px = 74;
constexpr int kRow_px = 20, kAxis_px = 30;
constexpr int kWidth_px = kLeft_px + kScale_px + kRight_px;

struct Row {
  const char* figure;
  Interval measured;
  double stated;  ///< by the device file
  std::string unit;
};

std::array<Row, 4> rowsOf(const PassportAxis& m, const DeviceAxis& axis, double delay_s) {
  const bool turns = axis.kind == AxisKind::kRotation;
  return {{{turns ? "inertia" : "mass", m.mass, axis.mass, turns ? "kg·m²" : "kg"},
           {"damping", m.damping, axis.damping, turns ? "N·m·s/rad" : "N·s/m"},
           {"dry friction", m.coulomb, axis.coulomb, axis.effortUnit()},
           {"delay", m.delay_s, delay_s, "s"}}};
}

double pixelOf(double share) {
  return kLeft_px + kScale_px * std::clamp(share / kMost, 0.0, 1.0);
}

std::string drawn(const Row& row, double y) {
  std::string out = svg::words(kLeft_px - 12, y + 4, row.figure, "end", kPlotInk);
  out += svg::segment(pixelOf(0.0), y, pixelOf(kMost), y, kPlotRule, 1.0);
  if (row.stated > 0.0) {
    out += svg::segment(pixelOf(row.measured.lower / row.stated), y,
                        pixelOf(row.measured.upper / row.stated), y, kPlotInk, 6.0);
  }
  return out + svg::words(kLeft_px + kScale_px + 12, y + 4,
                          fmt::format("{:.4g} to {:.4g} {}; file {:.4g}", row.measured.lower,
                                      row.measured.upper, row.unit, row.stated),
                          "start", kPlotInk2);
}

}  // namespace

std::string passportChart(const Passport& passport, const DeviceModel& device) {
  const int rows = static_cast<int>(rowsOf({}, {}, 0.0).size());
  const int axes = static_cast<int>(passport.axes.size());
  const int height = kTop_px + axes * (kAxis_px + rows * kRow_px) + 20;
  const std::string title =
      fmt::format("{}, serial number {}: measured {} by {}", device.name, passport.identity.serial,
                  format(passport.measured_on), passport.operator_name);
  std::string out = svg::opening(kWidth_px, height, title) +
                    "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>";
  out += svg::words(20, 26, title, "start", kPlotInk, 700, 16.0);
  out += svg::words(20, 46, "Thick: where the figure lies, as a share of the device file's number.",
                    "start", kPlotInk2);
  for (const double share : {0.0, 0.5, 1.0, 1.5, 2.0}) {
    out += svg::words(pixelOf(share), kTop_px - 6, fmt::format("{:g}", share), "middle", kPlotInk2);
    out += svg::segment(pixelOf(share), kTop_px, pixelOf(share), height - 20,
                        share == 1.0 ? kPlotRule2 : kPlotBand, 1.0);
  }
  double y = kTop_px;
  const double delay_s = device.output_delay_ticks / passport.rate_hz;
  for (std::size_t i = 0; i < passport.axes.size(); ++i) {
    y += kAxis_px;
    out += svg::words(20, y + 4, passport.axes[i].name, "start", kPlotInk, 700);
    for (const Row& row : rowsOf(passport.axes[i], device.axes[i], delay_s)) {
      out += drawn(row, y);
      y += kRow_px;
    }
  }
  return out + "</svg>\n";
}

}  // namespace wholehand
