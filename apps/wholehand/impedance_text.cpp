#include "impedance_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr std::array<double, 3> kTold_hz = {1.0, 10.0, 100.0};

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

/// Pads by characters instead of bytes.
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
  for (const double frequency_hz : kTold_hz) {
    out += padded(polar(best(curve, nearest(curve, frequency_hz))), 14);
  }
  if (!curve.not_measured.empty())
    return out + "\n    predicted only: " + curve.not_measured + "\n";
  return out + fmt::format("{:.3f} {:.2f}{}\n", curve.felt.decibel, curve.felt.degrees,
                           curve.felt.within() ? "" : "\n    DIFFERS");
}

/// As built: includes everything that the linear model neglects.
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

}  // namespace

const char* contactKey(ContactCase contact) {
  if (contact == ContactCase::kFree) return "free";
  return contact == ContactCase::kRigid ? "rigid" : "spring";
}

std::string massUnit(const DeviceAxis& axis) {
  return axis.kind == AxisKind::kTranslation ? "kg" : "kg·m²";
}
std::string stiffnessUnit(const DeviceAxis& axis) {
  return fmt::format("{}/{}", axis.effortUnit(), axis.positionUnit());
}
std::string impedanceUnit(const DeviceAxis& axis) {
  return fmt::format("{}·s/{}", axis.effortUnit(), axis.positionUnit());
}

const std::complex<double>& best(const ImpedanceCurve& curve, const ImpedancePoint& point) {
  return curve.not_measured.empty() ? point.measured.felt : point.predicted.felt;
}

std::string impedanceText(const ImpedanceReport& report) {
  std::string out = fmt::format(
      "What the person feels: {} with the gains {} and the hand {} at {:.4g} Hz\n"
      "spring: {:.4g} N/m at the simulated hand, on rotations times the lever arm squared\n\n",
      report.device, report.rendering, report.hand, 1.0 / report.period_s,
      report.contact_stiffness_n_m);
  out += padded("", 12) + padded("felt slowly", 15) + padded("effort over velocity at", 42) +
         "prediction\n";
  out += "  " + padded("contact", 7) + padded(" Φ", 3) + padded("(0.1 Hz)", 15);
  for (const double frequency_hz : kTold_hz) {
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

}  // namespace wholehand
