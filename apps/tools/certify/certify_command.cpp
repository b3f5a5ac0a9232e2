#include "apps/tools/certify/certify_command.hpp"

#include "apps/tools/certify/impedance_command.hpp"
#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "certify/certificate_refusal.hpp"
#include "certify/certificate_text.hpp"
#include "devices/passport/passport.hpp"
#include "exercises/load_exercise.hpp"
#include "files/device/device_file.hpp"
#include "files/device/rendering_file.hpp"
#include "files/hand/hand_file.hpp"
#include "files/page/chart_page.hpp"
#include "files/text/text_file.hpp"
#include "loop/core/printable.hpp"
#include "rig/models.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

template <class T>
void collect(const Expected<T>& loaded, Diagnostics& errors) {
  if (!loaded) errors.insert(errors.end(), loaded.errors().begin(), loaded.errors().end());
}

void takeWalls(LoadedExercise loaded, Models& models) {
  models.exercise = std::move(loaded.exercise);
  models.exercise_walls = std::move(loaded.walls);
}

/// Loads device, gains, hand and exercise; reports all faults of all files. Unstable gains are not
/// a fault of the file.
Expected<Models> loadFiles(const CertifyOptions& o) {
  Diagnostics errors;
  Models models;
  const auto device = loadDeviceFile(o.device);
  const auto hand_file = loadHandFile(o.hand);
  collect(device, errors);
  collect(hand_file, errors);
  bool rendering = false;
  if (device) {
    models.device = *device;
    const auto gains = loadRenderingFile(o.rendering, *device);
    collect(gains, errors);
    rendering = static_cast<bool>(gains);
    if (rendering) models.rendering = *gains;
  }
  if (device && hand_file) {
    const auto hand = assembleHand(*hand_file, *device);
    collect(hand, errors);
    if (hand) models.hand = *hand;
    if (hand && !o.exercise.empty()) {
      auto exercise = loadExercise(o.exercise, o.level, *device, *hand,
                                   rendering ? bearsWalls(models, 1.0 / o.rate_hz) : BearsWalls{});
      collect(exercise, errors);
      if (exercise) takeWalls(std::move(*exercise), models);
    }
  }
  if (!errors.empty()) return errors;
  return models;
}

AdvisedCertificate certifyWithAdvice(CertificateInput input) {
  AdvisedCertificate out;
  out.input = std::move(input);
  out.certificate = certify(out.input);
  for (std::size_t i = 0; i < out.certificate.axes.size(); ++i) {
    const AxisCase& c = out.certificate.axes[i].axis_case;
    std::size_t twin = 0;  // x, y and z are often equal
    while (twin < i && !sameCase(out.certificate.axes[twin].axis_case, c)) ++twin;
    out.advice.push_back(twin < i ? out.advice[twin] : advise(c));
  }
  if (!out.certificate.certified) out.nearest = nearestGains(out.input, out.certificate);
  return out;
}

// Device models to certify: the one of the file, or the passport's at both ends of its mass
// intervals.
Expected<std::vector<DeviceModel>> devicesToCertify(const CertifyOptions& o,
                                                    const DeviceModel& device) {
  if (o.passport.empty()) return std::vector<DeviceModel>{device};
  const auto passport = readPassport(o.passport);
  if (!passport) return passport.errors();
  // The connected device is unknown here; `run` checks it.
  if (auto fits = checkPassport(*passport, passport->identity, device, placeTimeNow()); !fits) {
    return fits.errors();
  }
  return worstCorners(device, *passport, 1.0 / o.rate_hz);
}

// Certificate of the device model with the smallest margin.
AdvisedCertificate certifyWorst(const Models& models, const std::vector<DeviceModel>& devices,
                                const CertifyOptions& o) {
  AdvisedCertificate worst;
  for (std::size_t i = 0; i < devices.size(); ++i) {
    CertificateInput input = certificateInput(models, 1.0 / o.rate_hz);
    input.device = devices[i];
    if (!o.passport.empty()) input.persons = Persons::kAny;
    AdvisedCertificate advised = certifyWithAdvice(std::move(input));
    if (!o.passport.empty()) {
      advised.corner = fmt::format("the worst corner of the passport {}: masses at their {} ends",
                                   printable(o.passport), i == 0 ? "lower" : "upper");
    }
    const bool worse = advised.certificate.certified == worst.certificate.certified
                           ? advised.certificate.margin() < worst.certificate.margin()
                           : !advised.certificate.certified;
    if (i == 0 || worse) worst = std::move(advised);
  }
  return worst;
}

constexpr int kZWidthPoints = 25;

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

/// Lines of every chart, in their order.
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
  for (const ZWidthPoint& point : zWidth(a.axis_case, kZWidthPoints)) {
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
    line.name = nullptr;  // the page's legend names the lines
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

/// Charts of the Z-width of every axis: largest stable stiffness against adaptive damping, and the
/// operating point. Axes that differ only in their names share a chart.
ChartPage certificateChart(const AdvisedCertificate& advised) {
  ChartPage page;
  const bool walls = !advised.input.exercise.empty();
  page.title =
      sentence(advised.certificate.certified ? "certificate.certified" : "certificate.notCertified",
               {{"device", advised.input.device.name},
                {"rendering", advised.input.rendering.name},
                {"hand", advised.input.hand}});
  if (walls) {
    page.notes.push_back(sentence("certificate.walls", {{"exercise", advised.input.exercise}}));
  }
  page.notes.push_back(sentence(
      "certificate.note", {{"rate", fmt::format("{:.4g}", 1.0 / advised.certificate.period_s)}}));
  page.legend = {rigidLine(), passiveLine(), quantisationLine(), workingLine()};
  if (walls) page.legend.push_back(wallLine());
  page.columns = 2;
  for (const Group& group : groupsOf(advised.certificate)) {
    page.charts.push_back(axisChart(advised.certificate.axes[group.first], group.names));
  }
  return page;
}

}  // namespace

int certifyCommand(const CertifyOptions& options) {
  const auto models = loadFiles(options);
  if (!models) return refuse(models.errors());
  if (options.impedance) {
    return impedanceCommand(*models,
                            {1.0 / options.rate_hz, options.contact_stiffness_n_m, options.engine},
                            options.json, options.charts);
  }
  if (auto ready = prepareCharts(options.charts, {options.json}); !ready) {
    return refuse(ready.errors());
  }
  const auto devices = devicesToCertify(options, models->device);
  if (!devices) return refuse(devices.errors());
  const AdvisedCertificate advised = certifyWorst(*models, *devices, options);
  std::fputs(certificateText(advised).c_str(), stdout);
  if (!options.json.empty()) {
    const auto done = writeText(options.json, jsonText(certificateJson(advised)));
    if (!done) return refuse(done.errors());
  }
  if (!options.charts.empty()) {
    const auto done = writeCharts(certificateChart(advised), options.charts);
    if (!done) return refuse(done.errors());
  }
  return advised.certificate.certified ? kExitDone : kExitNotCertified;
}

}  // namespace wholehand
