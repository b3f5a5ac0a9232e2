#include "impedance/impedance_measurement.hpp"

#include "device/simulated/simulated_device.hpp"
#include "impedance/impedance_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

using Complex = std::complex<double>;

// Speed of the device per line: small enough to avoid saturation and changes of posture, large
// compared with rounding.
constexpr double kLineSpeed_m_s = 1e-4, kLineSpeed_rad_s = 1e-3;
constexpr double kUsualLeverArm_m = 0.08;  // as in the certificate for a rotation without a tip
constexpr int kFinePoints = 300;           // points of a predicted line, which has sharp bends
// Measurement with dry friction: an everyday speed at 1 Hz.
constexpr double kUsualSpeed_m_s = 0.1, kUsualSpeed_rad_s = 1.0, kUsual_hz = 1.0;

constexpr const char* kNeverSettles = "the loop does not settle by itself";

/// Why the tick was not linear on the axis; empty: it was.
std::string interference(const TickRecord& record, const AxisEffort& neutral, int axis,
                         double phi) {
  if (any(record.faults & kStoppingFaults)) return "a fault stopped the loop";
  for (const double effort : record.tank_effort) {
    if (effort != 0.0) return "the energy tank stepped in";
  }
  if (record.phi[axis] != phi) return "the adaptive damping moved";
  const double linear = record.coupling[axis] + record.damping[axis] + neutral[axis];
  if (std::abs(record.sent[axis] - linear) > 1e-12 * (1.0 + std::abs(linear))) {
    return "a limit of the device was reached";
  }
  return {};
}

struct Phasors {
  std::string interference;
  std::vector<Complex> effort, position;
};

/// Runs the renderer until it has settled, then for one window.
Phasors listen(HapticRenderer& renderer, const ImpedanceBench& bench, int axis, double settle_s) {
  Phasors out;
  LineTransform effort(bench.grid), position(bench.grid);
  const int settle = static_cast<int>(std::ceil(settle_s / bench.grid.period_s));
  const AxisEffort neutral = bench.models.device.neutral();
  auto record = std::make_unique<TickRecord>();
  for (int k = 0; k < settle + bench.grid.window; ++k) {
    record->tick = static_cast<std::uint64_t>(k);
    record->time_s = k * bench.grid.period_s;
    renderer.tick(1, *record);
    if (k < settle) continue;
    out.interference = interference(*record, neutral, axis, bench.phi);
    if (!out.interference.empty()) return out;
    effort.add(record->patient_effort[axis]);
    position.add(record->q_m[axis] - bench.rest[axis]);
  }
  for (std::size_t i = 0; i < bench.grid.lines.size(); ++i) {
    out.effort.push_back(effort.phasor(i));
    out.position.push_back(position.phasor(i));
  }
  return out;
}

std::unique_ptr<Player> pushOf(const ImpedanceBench& bench, int axis, const PatientConfig& arm,
                               const ImpedanceCurve& curve) {
  const bool along = bench.models.device.axes[axis].kind == AxisKind::kTranslation;
  std::vector<double> amplitude;
  for (const ImpedancePoint& point : curve.points) {
    amplitude.push_back((along ? kLineSpeed_m_s : kLineSpeed_rad_s) *
                        std::abs(point.predicted.felt));
  }
  return std::make_unique<MultisinePlayer>(bench.rest, axis, bench.grid, amplitude,
                                           arm.axes[axis].stiffness);
}

void fill(const Phasors& heard, const AxisLoop& loop, ImpedanceCurve& curve) {
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    ImpedancePoint& point = curve.points[i];
    const double omega_rad_s = 2.0 * std::numbers::pi * point.frequency_hz;
    // The push is linear between samples. This is the sine with the same effect on the device.
    const Complex push = heard.effort[i] * linearHoldGain(loop, point.frequency_hz);
    point.measured.felt = push / (Complex(0.0, omega_rad_s) * heard.position[i]);
    point.measured.rendered = point.measured.felt - Complex(loop.damping, omega_rad_s * loop.mass);
    if (point.frequency_hz < kComparedFrom_hz || point.frequency_hz > kComparedTo_hz) continue;
    curve.felt.include(point.measured.felt, point.predicted.felt);
  }
}

void predict(const FeltLoop& felt, const LineGrid& grid, ImpedanceCurve& curve) {
  const FeltLoop alone = feltUncoupled(felt.loop);
  const double lowest_hz = grid.frequency_hz(0);
  const double span = grid.frequency_hz(grid.lines.size() - 1) / lowest_hz;
  for (int i = 0; i < kFinePoints; ++i) {
    const double frequency_hz = lowest_hz * std::pow(span, i / (kFinePoints - 1.0));
    curve.line.push_back({frequency_hz, feltImpedance(felt, curve.contact, frequency_hz).felt});
  }
  for (std::size_t i = 0; i < grid.lines.size(); ++i) {
    ImpedancePoint point;
    point.frequency_hz = grid.frequency_hz(i);
    point.predicted = feltImpedance(felt, curve.contact, point.frequency_hz);
    curve.points.push_back(point);
    if (point.frequency_hz < kComparedFrom_hz || point.frequency_hz > kComparedTo_hz) continue;
    curve.alone.include(feltImpedance(alone, curve.contact, point.frequency_hz).felt,
                        point.predicted.felt);
  }
}

/// Measures one push in one world with a new renderer.
Expected<Phasors> run(const ImpedanceBench& bench, int axis, const PatientConfig& arm,
                      std::unique_ptr<Player> push, PhysicsWorld& world, double settle_s) {
  SimulatedDevice device(bench.models.device, arm, std::move(push), bench.grid.period_s);
  HapticRenderer renderer(device, world, bench.rig->models.hand, bench.rig->models.scene,
                          bench.rig->renderer->config(), nullptr, &device);
  if (auto armed = renderer.arm(); !armed) return armed.errors();
  Phasors heard = listen(renderer, bench, axis, settle_s);
  device.close();
  return heard;
}

Expected<Done> measure(const ImpedanceBench& bench, int axis, ImpedanceCurve& curve) {
  const FeltLoop felt = feltLoop(bench, axis, curve.stiffness);
  predict(felt, bench.grid, curve);
  const double settle_s = settleTime(felt.loop, curve.contact);
  if (settle_s < 0.0) {
    curve.not_measured = kNeverSettles;
    return Done{};
  }
  const PatientConfig arm = armFor(bench.models.device, axis, bench.grid.frequency_hz(0));
  const bool free = curve.contact == ContactCase::kFree;
  const std::unique_ptr<PhysicsWorld> met =
      free ? nullptr : contactWorld(bench, axis, curve.contact, curve.stiffness);
  curve.engine = free ? bench.rig->options.engine : "analytic";
  const auto heard = run(bench, axis, arm, pushOf(bench, axis, arm, curve),
                         free ? *bench.rig->world : *met, settle_s);
  if (!heard) return heard.errors();
  curve.not_measured = heard->interference;
  if (heard->interference.empty()) fill(*heard, felt.loop, curve);
  return Done{};
}

/// Measures with dry friction, which adds 4 f_c / π to the effort's amplitude.
Expected<Done> measureAsBuilt(const ImpedanceBench& bench, int axis, ImpedanceAsBuilt& out) {
  const DeviceAxis& built = bench.models.device.axes[axis];
  const FeltLoop felt = feltLoop(bench, axis, 0.0);
  out.frequency_hz = bench.grid.frequency_hz(0);
  out.speed = built.kind == AxisKind::kTranslation ? kUsualSpeed_m_s : kUsualSpeed_rad_s;
  out.linear = feltImpedance(felt, ContactCase::kFree, out.frequency_hz).felt;
  const double settle_s = settleTime(felt.loop, ContactCase::kFree);
  if (settle_s < 0.0) {
    out.not_measured = kNeverSettles;
    return Done{};
  }
  const double friction = 4.0 * built.coulomb / (std::numbers::pi * out.speed);
  const PatientConfig arm = armFor(bench.models.device, axis, out.frequency_hz);
  auto push = std::make_unique<MultisinePlayer>(
      bench.rest, axis, bench.grid, std::vector{out.speed * std::abs(out.linear + friction)},
      arm.axes[axis].stiffness);
  const auto heard = run(bench, axis, arm, std::move(push), *bench.rig->world, settle_s);
  if (!heard) return heard.errors();
  out.not_measured = heard->interference;
  if (!heard->interference.empty()) return Done{};
  out.measured = heard->effort[0] * linearHoldGain(felt.loop, out.frequency_hz) /
                 (Complex(0.0, 2.0 * std::numbers::pi * out.frequency_hz) * heard->position[0]);
  return Done{};
}

std::string caseName(const ImpedanceCurve& curve) {
  const char* where = curve.contact == ContactCase::kFree    ? "free"
                      : curve.contact == ContactCase::kRigid ? "rigid stop"
                                                             : "spring";
  return fmt::format("{}, Φ = {:g}", where, curve.phi);
}

/// Stiffness of the contact in the axis's units.
double springOf(const DeviceAxis& axis, double contact_stiffness_n_m) {
  if (axis.kind == AxisKind::kTranslation) return contact_stiffness_n_m;
  const double arm_m = axis.lever_arm_m > 0.0 ? axis.lever_arm_m : kUsualLeverArm_m;
  return contact_stiffness_n_m * arm_m * arm_m;
}

}  // namespace

void ImpedanceDeviation::include(std::complex<double> measured, std::complex<double> predicted) {
  const Complex ratio = measured / predicted;
  include({std::abs(20.0 * std::log10(std::abs(ratio))),
           std::abs(std::arg(ratio)) * 180.0 / std::numbers::pi});
}

void ImpedanceDeviation::include(const ImpedanceDeviation& other) {
  if (!(other.decibel <= decibel)) decibel = other.decibel;  // NaN is the worst
  if (!(other.degrees <= degrees)) degrees = other.degrees;
}

bool ImpedanceReport::asPredicted() const {
  for (const AxisImpedance& axis : axes) {
    for (const ImpedanceCurve& curve : axis.curves) {
      if (!curve.not_measured.empty() || !curve.felt.within()) return false;
    }
  }
  return true;
}

Expected<ImpedanceReport> measureImpedance(const Models& models, const ImpedanceOptions& options,
                                           const ImpedanceProgress& progress) {
  ImpedanceReport report{models.device.name,
                         models.rendering.name,
                         models.hand.name,
                         options.period_s,
                         options.contact_stiffness_n_m,
                         options.engine,
                         {}};
  const AxisPosition rest = middleOf(models.device);
  for (int a = 0; a < models.device.axisCount(); ++a) {
    report.axes.push_back({models.device.axes[a], rest[a], {}, {}});
  }
  const int all = 7 * models.device.axisCount();
  int done = 0;
  for (const double phi : {0.0, 1.0}) {
    auto bench = makeImpedanceBench(models, phi, options, BenchDevice::kLinear);
    if (!bench) return bench.errors();
    for (int a = 0; a < models.device.axisCount(); ++a) {
      AxisImpedance& axis = report.axes[a];
      for (const ContactCase c : {ContactCase::kFree, ContactCase::kObject, ContactCase::kRigid}) {
        ImpedanceCurve curve;
        curve.contact = c;
        curve.phi = phi;
        if (c == ContactCase::kObject) {
          curve.stiffness = springOf(axis.axis, options.contact_stiffness_n_m);
        }
        progress(axis.axis.name + ", " + caseName(curve), done++, all);
        if (auto ok = measure(*bench, a, curve); !ok) return ok.errors();
        axis.curves.push_back(std::move(curve));
      }
    }
  }
  auto bench = makeImpedanceBench(models, 0.0, options, BenchDevice::kAsBuilt);
  if (!bench) return bench.errors();
  bench->grid = oneLine(kUsual_hz, options.period_s);
  for (int a = 0; a < models.device.axisCount(); ++a) {
    AxisImpedance& axis = report.axes[a];
    progress(axis.axis.name + " with its dry friction", done++, all);
    if (auto ok = measureAsBuilt(*bench, a, axis.as_built); !ok) return ok.errors();
  }
  return report;
}

}  // namespace wholehand
