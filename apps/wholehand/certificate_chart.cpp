#include "certificate_chart.hpp"

#include "control/certificate/certificate_advice.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace wholehand {
namespace {

constexpr int kPoints = 25;

/// Axes of one kind, represented by the first.
struct Group {
  std::size_t first = 0;
  std::string names;
};

std::vector<Group> groupsOf(const Certificate& certificate) {
  std::vector<Group> groups;
  for (std::size_t i = 0; i < certificate.axes.size(); ++i) {
    const AxisCase& c = certificate.axes[i].axis_case;
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
      return sameCase(certificate.axes[group.first].axis_case, c);
    });
    if (same != groups.end()) {
      same->names += ", " + c.axis.name;
    } else {
      groups.push_back({i, c.axis.name});
    }
  }
  return groups;
}

/// The lines of every chart, in their order.
ChartLine rigidLine() {
  return {sentence("certificate.rigid"), "--ink-2", {6, 3}, 1.5};
}
ChartLine passiveLine() {
  return {sentence("certificate.passive"), "--ax-z", {}, 1.8};
}
ChartLine quantisationLine() {
  return {sentence("certificate.quantisation"), "--ax-f", {2, 3}, 1.5};
}
ChartLine wallLine() {
  return {sentence("certificate.wall"), "--ax-c", {4, 2}, 1.8};
}
ChartLine workingLine() {
  return {sentence("certificate.working"), "--ax-x", {}, 5.0};
}

/// Lines for the limits of one axis; they end where no stiffness is allowed.
std::vector<ChartLine> limitLines(const AxisCertificate& a) {
  ChartLine rigid = rigidLine(), passive = passiveLine(), wall = wallLine();
  const auto allowed = [](double stiffness) {
    return stiffness > 0.0 ? stiffness : ChartScale::kFromData;
  };
  for (const ZWidthPoint& point : zWidth(a.axis_case, kPoints)) {
    rigid.points.push_back({point.damping, allowed(point.rigid)});
    passive.points.push_back({point.damping, allowed(point.passive)});
    if (!a.axis_case.walls.empty()) wall.points.push_back({point.damping, allowed(point.walled)});
  }
  const double end = rigid.points.back()[0];
  ChartLine quantisation = quantisationLine();
  quantisation.points = {{0.0, allowed(a.quantisationLimit())},
                         {end, allowed(a.quantisationLimit())}};
  std::vector<ChartLine> lines = {rigid, passive, quantisation};
  if (!wall.points.empty()) lines.push_back(wall);
  return lines;
}

Chart axisChart(const AxisCertificate& a, const std::string& names) {
  const DeviceAxis& axis = a.axis_case.axis;
  Chart chart;
  chart.title = sentence(
      "certificate.chart",
      {{"axes", names}, {"unit", std::string(axis.effortUnit()) + "/" + axis.positionUnit()}});
  chart.height_px = 210;
  chart.x.unit = std::string(axis.effortUnit()) + "·s/" + axis.positionUnit();
  chart.y.logarithmic = true;
  chart.lines = limitLines(a);
  const double end = chart.lines.front().points.back()[0];
  ChartLine working = workingLine();
  if (!a.passes) working.color = "--bad";
  working.points = {
      {0.0, a.axis_case.gains.k_pm},
      {a.axis_case.gains.k_dm > 0.0 ? a.axis_case.gains.k_dm : 0.01 * end, a.axis_case.gains.k_pm}};
  double lowest = a.axis_case.gains.k_pm, highest = lowest;
  for (ChartLine& line : chart.lines) {
    line.name = nullptr;  // the page's legend has it
    for (const auto& [damping, stiffness] : line.points) {
      if (stiffness < lowest) lowest = stiffness;
      if (stiffness > highest) highest = stiffness;
    }
  }
  working.name = a.passes ? PageText(nullptr) : sentence("certificate.fails");
  chart.lines.push_back(std::move(working));
  chart.y.from = 0.5 * lowest;
  chart.y.to = 2.0 * highest;
  return chart;
}

}  // namespace

ChartPage certificateChart(const AdvisedCertificate& judged) {
  ChartPage page;
  const bool walls = !judged.input.exercise.empty();
  page.title =
      sentence(judged.certificate.certified ? "certificate.certified" : "certificate.notCertified",
               {{"device", judged.input.device.name},
                {"rendering", judged.input.rendering.name},
                {"hand", judged.input.hand}});
  if (walls) {
    page.notes.push_back(sentence("certificate.walls", {{"exercise", judged.input.exercise}}));
  }
  page.notes.push_back(sentence(
      "certificate.note", {{"rate", fmt::format("{:.4g}", 1.0 / judged.certificate.period_s)}}));
  page.legend = {rigidLine(), passiveLine(), quantisationLine(), workingLine()};
  if (walls) page.legend.push_back(wallLine());
  page.columns = 2;
  for (const Group& group : groupsOf(judged.certificate)) {
    page.charts.push_back(axisChart(judged.certificate.axes[group.first], group.names));
  }
  return page;
}

}  // namespace wholehand
