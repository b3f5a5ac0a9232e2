#include "impedance_measurement.hpp"

#include "assembly/rig.hpp"
#include "device/simulated/simulated_device.hpp"
#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "impedance_multisine.hpp"
#include "physics/analytic/analytic_world.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

using Complex = std::complex<double>;

// Each line alone moves the device at this speed: small enough that nothing saturates and that the
// hand's posture does not change, large against rounding.
constexpr double kLineSpeed_m_s = 1e-4, kLineSpeed_rad_s = 1e-3;
constexpr double kUsualLeverArm_m = 0.08;  // as in the certificate, where a rotation has no tip
constexpr double kLeastSettle_s = 1.5, kMostSettle_s = 60.0;
constexpr double kLeftOfTransient = 1e-7;

/// What stays the same for all curves of an axis at one Φ.
struct Bench {
  Models models;  ///< linear: no dry friction, no encoder steps, Φ held
  std::unique_ptr<Rig> rig;
  AxisPosition rest;
  AxisMatrix inertia;
  LineGrid grid;
};

AxisPosition middleOf(const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[static_cast<std::size_t>(a)];
    q[a] = 0.5 * (axis.lower + axis.upper);
  }
  return q;
}

/// Φ held at 0 or 1 by thresholds that no effort, or every effort, passes.
void holdDamping(RenderingConfig& rendering, double phi) {
  for (AxisRendering& axis : rendering.axes) {
    axis.effort_dead = phi > 0.0 ? 0.0 : 1e9;
    axis.effort_full = phi > 0.0 ? 1e-12 : 2e9;
    axis.decay_s = phi > 0.0 ? 1e12 : 0.1;
    axis.palm_contact = true;
  }
}

Models linearModels(const Models& from, double phi) {
  Models models;
  models.files = from.files;
  models.device = from.device;
  models.rendering = from.rendering;
  models.hand = from.hand;
  for (DeviceAxis& axis : models.device.axes) axis.coulomb = axis.encoder_step = 0.0;
  holdDamping(models.rendering, phi);
  return models;
}

/// One axis that feels nothing but the push, the others in a vice.
PatientConfig armFor(const DeviceModel& device, int axis, double lowest_hz) {
  PatientConfig arm;
  for (const DeviceAxis& d : device.axes) {
    constexpr double kVice_rad_s = 1e4;
    arm.axes.push_back(
        {d.name, 0.0, 2.0 * d.mass * kVice_rad_s, d.mass * kVice_rad_s * kVice_rad_s});
  }
  // A millionth of what the device's mass does at the lowest line.
  const double lowest_rad_s = 2.0 * std::numbers::pi * lowest_hz;
  PatientAxis& pushed = arm.axes[static_cast<std::size_t>(axis)];
  pushed.damping = 0.0;
  pushed.stiffness =
      1e-6 * device.axes[static_cast<std::size_t>(axis)].mass * lowest_rad_s * lowest_rad_s;
  return arm;
}

AxisMatrix inertiaAt(const HandModel& hand, const AxisPosition& q) {
  ArticulatedBody body(hand);
  JointPosition theta;
  Synergy(hand).expand(q, theta);
  [[maybe_unused]] const bool definite =
      body.update(theta, JointVelocity(hand.joint_count), Eigen::Vector3d::Zero());
  return body.reducedInertia();
}

FeltLoop feltLoop(const Bench& bench, int axis, double phi, double stiffness) {
  const CouplingGains& gains = bench.rig->gains;
  FeltLoop felt;
  felt.loop = axisLoop(bench.models.device, gains, axis, bench.grid.period_s);
  felt.loop.phi_k_dm *= phi;
  felt.loop.spring_per_s2 = stiffness / bench.inertia(axis, axis);
  felt.axis = axis;
  felt.inertia = bench.inertia;
  felt.k_ps_per_s2 = gains.k_ps_per_s2;
  felt.k_ds_per_s = gains.k_ds_per_s;
  return felt;
}

/// How long until a transient has died away; negative: never. A drift of device and hand together
/// (eigenvalue 1) is a constant, which no line sees.
double settleTime(const AxisLoop& loop, ContactCase contact) {
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(closedLoopMatrix(loop, contact), false);
  double slowest = 0.0;
  bool drift = contact != ContactCase::kFree;
  for (const Complex& pole : solver.eigenvalues()) {
    if (!drift && std::abs(pole - 1.0) < 1e-9) {
      drift = true;
    } else {
      slowest = std::max(slowest, std::abs(pole));
    }
  }
  if (!(slowest < 1.0)) return -1.0;
  const double settle_s = loop.period_s * std::log(kLeftOfTransient) / std::log(slowest);
  return settle_s <= kMostSettle_s ? std::max(settle_s, kLeastSettle_s) : -1.0;
}

/// A spring solved after the step, as an engine solves contacts, is in a world that solves it
/// before the step: M (v⁺ − v) = T (f − k (q + T v⁺)) with the mass T²k and the damping T k more.
std::unique_ptr<PhysicsWorld> contactWorld(const Bench& bench, int axis, ContactCase contact,
                                           double stiffness) {
  AnalyticScene scene;
  scene.gravity_m_s2 = bench.rig->renderer->config().gravity_m_s2;
  scene.axes.resize(static_cast<std::size_t>(bench.rest.size()));
  AnalyticAxis& met = scene.axes[static_cast<std::size_t>(axis)];
  const double period_s = bench.grid.period_s;
  if (contact == ContactCase::kRigid) {
    met.lower_stop = met.upper_stop = bench.rest[axis];
  } else {
    met.stiffness = stiffness;
    met.damping = period_s * stiffness;
    met.added_mass = period_s * period_s * stiffness;
    met.spring_rest = bench.rest[axis];
  }
  return std::make_unique<AnalyticWorld>(bench.rig->models.hand, scene);
}

/// What kept the tick from being linear on the axis; empty: nothing.
std::string interference(const TickRecord& record, const AxisEffort& neutral, int axis,
                         double phi) {
  if (any(record.faults & kStopping)) return "a fault stopped the loop";
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

/// Lets the renderer run: first until it has settled, then for one window.
Phasors listen(HapticRenderer& renderer, const Bench& bench, int axis, double phi,
               double settle_s) {
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
    out.interference = interference(*record, neutral, axis, phi);
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

std::unique_ptr<Player> pushOf(const Bench& bench, int axis, const PatientConfig& arm,
                               const ImpedanceCurve& curve) {
  const bool along =
      bench.models.device.axes[static_cast<std::size_t>(axis)].kind == AxisKind::kTranslation;
  std::vector<double> amplitude;
  for (const ImpedancePoint& point : curve.points) {
    amplitude.push_back((along ? kLineSpeed_m_s : kLineSpeed_rad_s) *
                        std::abs(point.predicted.felt));
  }
  return std::make_unique<MultisinePlayer>(bench.rest, axis, bench.grid, amplitude,
                                           arm.axes[static_cast<std::size_t>(axis)].stiffness);
}

void fill(const Phasors& heard, const AxisLoop& loop, ImpedanceCurve& curve) {
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    ImpedancePoint& point = curve.points[i];
    const double omega_rad_s = 2.0 * std::numbers::pi * point.frequency_hz;
    // The push ran straight from sample to sample: this is the sine that moves the device alike.
    const Complex push = heard.effort[i] * linearHoldGain(loop, point.frequency_hz);
    point.measured.felt = push / (Complex(0.0, omega_rad_s) * heard.position[i]);
    point.measured.rendered = point.measured.felt - Complex(loop.damping, omega_rad_s * loop.mass);
    if (point.frequency_hz < kComparedFrom_hz || point.frequency_hz > kComparedTo_hz) continue;
    curve.felt.include(point.measured.felt, point.predicted.felt);
  }
}

void predict(const FeltLoop& felt, const LineGrid& grid, ImpedanceCurve& curve) {
  const FeltLoop alone = feltAlone(felt.loop);
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

Expected<Done> measure(Bench& bench, int axis, ImpedanceCurve& curve) {
  const FeltLoop felt = feltLoop(bench, axis, curve.phi, curve.stiffness);
  predict(felt, bench.grid, curve);
  const double settle_s = settleTime(felt.loop, curve.contact);
  if (settle_s < 0.0) {
    curve.not_measured = "the loop does not settle by itself";
    return Done{};
  }
  const PatientConfig arm = armFor(bench.models.device, axis, bench.grid.frequency_hz(0));
  const double period_s = bench.grid.period_s;
  SimulatedDevice device(bench.models.device, arm, pushOf(bench, axis, arm, curve), period_s);
  const bool free = curve.contact == ContactCase::kFree;
  const std::unique_ptr<PhysicsWorld> met =
      free ? nullptr : contactWorld(bench, axis, curve.contact, curve.stiffness);
  curve.engine = free ? "bullet" : "analytic";
  HapticRenderer renderer(device, free ? *bench.rig->world : *met, bench.rig->models.hand,
                          bench.rig->renderer->config());
  if (auto armed = renderer.arm(); !armed) return armed.errors();
  const Phasors heard = listen(renderer, bench, axis, curve.phi, settle_s);
  device.close();
  curve.not_measured = heard.interference;
  if (heard.interference.empty()) fill(heard, felt.loop, curve);
  return Done{};
}

Expected<Bench> makeBench(const Models& models, double phi, double period_s) {
  Bench bench;
  bench.models = linearModels(models, phi);
  bench.grid = lineGrid(period_s);
  bench.rest = middleOf(bench.models.device);
  bench.inertia = inertiaAt(bench.models.hand, bench.rest);
  Models own = bench.models;
  own.patient = armFor(own.device, 0, bench.grid.frequency_hz(0));
  RigOptions options;
  options.period_s = period_s;
  options.uncertified = true;  // nobody is moved
  auto player = std::make_unique<MultisinePlayer>(
      bench.rest, 0, bench.grid, std::vector<double>(bench.grid.lines.size(), 0.0), 1.0);
  auto rig = buildRig(std::move(own), std::move(player), options);
  if (!rig) return rig.errors();
  bench.rig = std::move(*rig);
  return bench;
}

std::string caseName(const ImpedanceCurve& curve) {
  const char* where = curve.contact == ContactCase::kFree    ? "free"
                      : curve.contact == ContactCase::kRigid ? "rigid stop"
                                                             : "spring";
  return fmt::format("{}, Φ = {:g}", where, curve.phi);
}

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
  if (!(other.decibel <= decibel)) decibel = other.decibel;  // not a number is the worst
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
  ImpedanceReport report{models.device.name, models.rendering.name,         models.hand.name,
                         options.period_s,   options.contact_stiffness_n_m, {}};
  const AxisPosition rest = middleOf(models.device);
  for (int a = 0; a < models.device.axisCount(); ++a) {
    report.axes.push_back({models.device.axes[static_cast<std::size_t>(a)], rest[a], {}});
  }
  const int all = 6 * models.device.axisCount();
  int done = 0;
  for (const double phi : {0.0, 1.0}) {
    auto bench = makeBench(models, phi, options.period_s);
    if (!bench) return bench.errors();
    for (int a = 0; a < models.device.axisCount(); ++a) {
      AxisImpedance& axis = report.axes[static_cast<std::size_t>(a)];
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
  return report;
}

}  // namespace wholehand
