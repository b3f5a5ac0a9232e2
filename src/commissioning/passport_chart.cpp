#include "commissioning/passport_chart.hpp"

#include <fmt/format.h>

#include <array>

namespace wholehand {
namespace {

constexpr double kMost = 2.0;  // upper end of the scale, relative to the file's value

struct Row {
  const char* figure;
  Interval measured;
  double stated;  ///< value of the device file
  std::string unit;
};

std::array<Row, 4> rowsOf(const PassportAxis& m, const DeviceAxis& axis, double delay_s) {
  const bool turns = axis.kind == AxisKind::kRotation;
  return {
      {{turns ? "passport.inertia" : "passport.mass", m.mass, axis.mass, turns ? "kg·m²" : "kg"},
       {"passport.damping", m.damping, axis.damping, turns ? "N·m·s/rad" : "N·s/m"},
       {"passport.friction", m.coulomb, axis.coulomb, axis.effortUnit()},
       {"passport.delay", m.delay_s, delay_s, "s"}}};
}

std::vector<PageText> cells(const Row& row) {
  const PageText bar = row.stated > 0.0 ? intervalBar(row.measured.lower / row.stated,
                                                      row.measured.upper / row.stated, kMost)
                                        : PageText("");
  return {sentence(row.figure), bar,
          sentence("passport.between", {{"low", fmt::format("{:.4g}", row.measured.lower)},
                                        {"high", fmt::format("{:.4g}", row.measured.upper)},
                                        {"unit", row.unit}}),
          fmt::format("{:.4g}", row.stated)};
}

}  // namespace

ChartPage passportChart(const Passport& passport, const DeviceModel& device) {
  ChartPage page;
  page.title =
      sentence("passport.title", {{"device", device.name}, {"serial", passport.identity.serial}});
  page.notes = {sentence("passport.measured", {{"day", format(passport.measured_at.day())},
                                               {"operator", passport.operator_name}}),
                sentence("passport.note")};
  const double delay_s = device.output_delay_ticks / passport.rate_hz;
  for (std::size_t i = 0; i < passport.axes.size(); ++i) {
    ChartTable table;
    table.title = sentence("axis", {{"axes", passport.axes[i].name}});
    table.heads = {sentence("passport.figure"), sentence("passport.share"),
                   sentence("passport.interval"), sentence("passport.file")};
    for (const Row& row : rowsOf(passport.axes[i], device.axes[i], delay_s)) {
      table.rows.push_back(cells(row));
    }
    page.tables.push_back(std::move(table));
  }
  return page;
}

}  // namespace wholehand
