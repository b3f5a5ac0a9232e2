#include "apps/tools/certify/impedance_command.hpp"

#include "apps/wholehand/shared/exit_code.hpp"
#include "apps/wholehand/shared/result_files.hpp"
#include "files/page/chart_page.hpp"
#include "files/text/text_file.hpp"
#include "rig/impedance/impedance_measurement.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <unistd.h>

namespace wholehand {
namespace {

/// Key of a contact: "free", "spring" or "rigid".
const char* contactKey(ContactCase contact) {
  if (contact == ContactCase::kFree) return "free";
  return contact == ContactCase::kRigid ? "rigid" : "spring";
}

/// Units by kind of axis: "kg" or "kg·m²"; "N/m" or "N·m/rad"; "N·s/m" or "N·m·s/rad".
std::string massUnit(const DeviceAxis& axis) {
  return axis.kind == AxisKind::kTranslation ? "kg" : "kg·m²";
}
std::string stiffnessUnit(const DeviceAxis& axis) {
  return fmt::format("{}/{}", axis.effortUnit(), axis.positionUnit());
}
std::string impedanceUnit(const DeviceAxis& axis) {
  return fmt::format("{}·s/{}", axis.effortUnit(), axis.positionUnit());
}

/// The measured value of a point; the predicted one if nothing was measured.
const std::complex<double>& best(const ImpedanceCurve& curve, const ImpedancePoint& point) {
  return curve.not_measured.empty() ? point.measured.felt : point.predicted.felt;
}

constexpr std::array<double, 3> kReported_hz = {1.0, 10.0, 100.0};

const ImpedancePoint& nearest(const ImpedanceCurve& curve, double frequency_hz) {
  return *std::min_element(curve.points.begin(), curve.points.end(),
                           [&](const ImpedancePoint& a, const ImpedancePoint& b) {
                             return std::abs(std::log(a.frequency_hz / frequency_hz)) <
                                    std::abs(std::log(b.frequency_hz / frequency_hz));
                           });
}

/// Felt impedance at the lowest frequency.
std::string feltSlowly(const AxisImpedance& axis, const ImpedanceCurve& curve) {
  const ImpedancePoint& point = curve.points.front();
  const double omega_rad_s = 2.0 * std::numbers::pi * point.frequency_hz;
  const double reactive = best(curve, point).imag();
  if (curve.contact == ContactCase::kFree) {
    return fmt::format("{:.3g} {}", reactive / omega_rad_s, massUnit(axis.axis));
  }
  return fmt::format("{:.4g} {}", -reactive * omega_rad_s, stiffnessUnit(axis.axis));
}

std::string polar(const std::complex<double>& z) {
  return fmt::format("{:.3g} ∠{:.0f}°", std::abs(z), std::arg(z) * 180.0 / std::numbers::pi);
}

/// Pads to a width in characters, not bytes.
std::string padded(const std::string& text, std::size_t width) {
  const auto letters = static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
  return text + std::string(width > letters ? width - letters : 0, ' ');
}

// Row of one axis; at most 80 characters, so that a terminal does not break it.
std::string row(const AxisImpedance& axis, const ImpedanceCurve& curve) {
  std::string out = "  " + padded(contactKey(curve.contact), 7) +
                    padded(fmt::format("{:g}", curve.phi), 3) + padded(feltSlowly(axis, curve), 15);
  for (const double frequency_hz : kReported_hz) {
    out += padded(polar(best(curve, nearest(curve, frequency_hz))), 14);
  }
  if (!curve.not_measured.empty())
    return out + "\n    predicted only: " + curve.not_measured + "\n";
  return out + fmt::format("{:.3f} {:.2f}{}\n", curve.felt.decibel, curve.felt.degrees,
                           curve.felt.within() ? "" : "\n    DIFFERS");
}

/// Table of the impedance with everything that the linear model neglects.
std::string asBuiltTable(const ImpedanceReport& report) {
  std::string out =
      "\nWith the device's dry friction and encoder steps, free, Φ = 0, a sine of 1 Hz:\n";
  for (const AxisImpedance& axis : report.axes) {
    const ImpedanceAsBuilt& built = axis.as_built;
    out += padded(axis.axis.name, 20) +
           padded(fmt::format("{:g} {}/s", built.speed, axis.axis.positionUnit()), 11);
    out += built.not_measured.empty()
               ? padded(polar(built.measured), 18) + "without " + polar(built.linear) + "\n"
               : "not measured: " + built.not_measured + "\n";
  }
  return out;
}

struct Worst {
  ImpedanceDeviation deviation, alone;
  std::string where;
  int not_measured = 0;
};

Worst worstOf(const ImpedanceReport& report) {
  Worst worst;
  for (const AxisImpedance& axis : report.axes) {
    for (const ImpedanceCurve& curve : axis.curves) {
      worst.alone.include(curve.alone);
      if (!curve.not_measured.empty()) {
        ++worst.not_measured;
        continue;
      }
      if (worst.where.empty() || curve.felt.decibel > worst.deviation.decibel) {
        worst.where =
            fmt::format("{}, {}, Φ = {:g}", axis.axis.name, contactKey(curve.contact), curve.phi);
      }
      worst.deviation.include(curve.felt);
    }
  }
  return worst;
}

std::string verdict(const ImpedanceReport& report) {
  const Worst worst = worstOf(report);
  std::string out;
  if (!worst.where.empty()) {
    out = fmt::format(
        "Measured against predicted, {:g} to {:g} Hz: at worst {:.4f} dB ({}) and {:.3f}°; {} {:g} "
        "dB "
        "and {:g}°.\n",
        kComparedFrom_hz, kComparedTo_hz, worst.deviation.decibel, worst.where,
        worst.deviation.degrees, worst.deviation.within() ? "within" : "NOT within", kMost_db,
        kMost_deg);
  }
  if (worst.not_measured > 0) {
    out += fmt::format("NOT measured: {} of {} curves.\n", worst.not_measured,
                       report.axes.size() * report.axes.front().curves.size());
  }
  return out +
         fmt::format(
             "The certificate's view of each axis alone, without the inertia that couples the "
             "hand's axes, is off by up to {:.2g} dB and {:.2g}°.\n",
             worst.alone.decibel, worst.alone.degrees);
}

/// A table with a row per curve, the measurement conditions, and the largest deviation.
std::string impedanceText(const ImpedanceReport& report) {
  std::string out = fmt::format(
      "What the person feels: {} with the gains {} and the hand {} at {:.4g} Hz\n"
      "spring: {:.4g} N/m at the simulated hand, on rotations times the lever arm squared\n\n",
      report.device, report.rendering, report.hand, 1.0 / report.period_s,
      report.contact_stiffness_n_m);
  out += padded("", 12) + padded("felt slowly", 15) + padded("effort over velocity at", 42) +
         "prediction\n";
  out += "  " + padded("contact", 7) + padded(" Φ", 3) + padded("(0.1 Hz)", 15);
  for (const double frequency_hz : kReported_hz) {
    out += padded(fmt::format("{:g} Hz", frequency_hz), 14);
  }
  out += "off dB  °\n";
  for (const AxisImpedance& axis : report.axes) {
    out += fmt::format("{} in {}\n", axis.axis.name, impedanceUnit(axis.axis));
    for (const ImpedanceCurve& curve : axis.curves) out += row(axis, curve);
  }
  return out +
         "\nMeasured on the running renderer with a push of many sines, one axis at a time,\n"
         "the others held; free motion in " +
         report.engine +
         ", contact in the analytic world; the\n"
         "device's dry friction and encoder steps, which are not linear, left out.\n" +
         asBuiltTable(report) + "\n" + verdict(report);
}

using Json = nlohmann::ordered_json;
using Impedances = std::vector<std::complex<double>>;

Json polarJson(const Impedances& z) {
  Json json{{"magnitude", Json::array()}, {"phase_deg", Json::array()}};
  for (const std::complex<double>& value : z) {
    json["magnitude"].push_back(std::abs(value));
    json["phase_deg"].push_back(std::arg(value) * 180.0 / std::numbers::pi);
  }
  return json;
}

Json deviationJson(const ImpedanceDeviation& deviation) {
  return {{"db", deviation.decibel}, {"deg", deviation.degrees}};
}

template <class Which>
Json bothJson(const ImpedanceCurve& curve, Which which) {
  Impedances felt, rendered;
  for (const ImpedancePoint& point : curve.points) {
    felt.push_back((point.*which).felt);
    rendered.push_back((point.*which).rendered);
  }
  Json json = polarJson(felt);
  json["rendering_alone"] = polarJson(rendered);
  return json;
}

Json curveJson(const ImpedanceCurve& curve) {
  Json json;
  json["contact"] = contactKey(curve.contact);
  json["phi"] = curve.phi;
  if (curve.contact == ContactCase::kObject) json["contact_stiffness"] = curve.stiffness;
  const ImpedancePoint& slow = curve.points.front();
  const double omega_rad_s = 2.0 * std::numbers::pi * slow.frequency_hz;
  const double reactive = best(curve, slow).imag();
  if (curve.contact == ContactCase::kFree) {
    json["felt_mass"] = reactive / omega_rad_s;
  } else {
    json["felt_stiffness"] = -reactive * omega_rad_s;
  }
  json["frequency_hz"] = Json::array();
  for (const ImpedancePoint& point : curve.points)
    json["frequency_hz"].push_back(point.frequency_hz);
  json["predicted"] = bothJson(curve, &ImpedancePoint::predicted);
  if (curve.not_measured.empty()) {
    json["world"] = curve.engine;
    json["measured"] = bothJson(curve, &ImpedancePoint::measured);
    json["deviation"] = deviationJson(curve.felt);
  } else {
    json["measured"] = nullptr;
    json["not_measured"] = curve.not_measured;
  }
  json["axis_alone_deviation"] = deviationJson(curve.alone);
  return json;
}

Json asBuiltJson(const ImpedanceAsBuilt& built) {
  Json json{{"frequency_hz", built.frequency_hz}, {"speed", built.speed}};
  json["linear"] = polarJson({built.linear});
  if (built.not_measured.empty()) {
    json["measured"] = polarJson({built.measured});
  } else {
    json["measured"] = nullptr;
    json["not_measured"] = built.not_measured;
  }
  return json;
}

/// The JSON under "impedance" (docs/impedance.md).
Json impedanceJson(const ImpedanceReport& report) {
  ImpedanceDeviation worst;
  Json axes = Json::array();
  for (const AxisImpedance& axis : report.axes) {
    Json json{{"name", axis.axis.name},
              {"unit", impedanceUnit(axis.axis)},
              {"position", axis.position},
              {"curves", Json::array()}};
    for (const ImpedanceCurve& curve : axis.curves) {
      json["curves"].push_back(curveJson(curve));
      if (curve.not_measured.empty()) worst.include(curve.felt);
    }
    json["as_built"] = asBuiltJson(axis.as_built);
    axes.push_back(std::move(json));
  }
  Json json;
  json["as_predicted"] = report.asPredicted();
  json["compared_hz"] = {kComparedFrom_hz, kComparedTo_hz};
  json["deviation"] = deviationJson(worst);
  json["contact_stiffness_n_m"] = report.contact_stiffness_n_m;
  json["axes"] = std::move(axes);
  return json;
}

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

/// Draws a prediction as a line and its measurement as dots.
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

/// Chart of magnitude or phase of one axis.
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

/// A Bode plot for every axis: magnitude above phase, predictions as lines, measurements as dots;
/// free, on the spring and against the rigid stop, Φ = 0 and 1.
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

/// Progress line, rewritten in place on a terminal; silent elsewhere.
void showProgress(const std::string& what, int done, int all) {
  if (isatty(STDERR_FILENO) == 0) return;
  std::fprintf(stderr, "\r\033[Kmeasuring %s (%d of %d)", what.c_str(), done + 1, all);
}

void endProgress() {
  if (isatty(STDERR_FILENO) != 0) std::fputs("\r\033[K", stderr);
}

}  // namespace

int impedanceCommand(const Models& models, const ImpedanceOptions& options, const std::string& json,
                     const std::string& charts) {
  if (auto ready = prepareCharts(charts, {json}); !ready) return refuse(ready.errors());
  const auto report = measureImpedance(models, options, showProgress);
  endProgress();
  if (!report) return refuse(report.errors());
  std::fputs(impedanceText(*report).c_str(), stdout);
  if (!json.empty()) {
    nlohmann::ordered_json all;
    all["rate_hz"] = 1.0 / report->period_s;
    all["device"] = report->device;
    all["rendering"] = report->rendering;
    all["hand"] = report->hand;
    all["impedance"] = impedanceJson(*report);
    if (auto done = writeText(json, jsonText(all, 1)); !done) return refuse(done.errors());
  }
  if (!charts.empty()) {
    const auto done = writeCharts(impedanceChart(*report), charts);
    if (!done) return refuse(done.errors());
  }
  return report->asPredicted() ? kExitDone : kExitNotCertified;
}

}  // namespace wholehand
