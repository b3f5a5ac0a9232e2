#include "rig/impedance/impedance_measurement.hpp"

#include "loop/device/simulated/simulated_device.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/physics/analytic/analytic_world.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kWindow_s = 10.0;  // one period of the lowest spectral line
constexpr double kLinesPerDecade = 14.0;
constexpr double kFade_s = 0.5;  // a gradual onset leaves a smaller transient

constexpr double kLeastSettle_s = 1.5, kMostSettle_s = 60.0;
constexpr double kLeftOfTransient = 1e-7;

/// Fixes Φ at 0 or 1 with thresholds that no effort or every effort exceeds.
void holdDamping(RenderingConfig& rendering, double phi) {
  for (AxisRendering& axis : rendering.axes) {
    axis.effort_dead = phi > 0.0 ? 0.0 : 1e9;
    axis.effort_full = phi > 0.0 ? 1e-12 : 2e9;
    axis.decay_s = phi > 0.0 ? 1e12 : 0.1;
    axis.palm_contact = true;
  }
}

Models modelsFor(const Models& from, double phi, BenchDevice device) {
  Models models;
  models.files = from.files;
  models.device = from.device;
  models.rendering = from.rendering;
  models.hand = from.hand;
  if (device == BenchDevice::kLinear) {
    for (DeviceAxis& axis : models.device.axes) axis.coulomb = axis.encoder_step = 0.0;
  }
  holdDamping(models.rendering, phi);
  return models;
}

AxisMatrix inertiaAt(const HandModel& hand, const AxisPosition& q) {
  ArticulatedBody body(hand);
  JointPosition theta;
  Synergy(hand).expand(q, theta);
  [[maybe_unused]] const bool definite =
      body.update(theta, JointVelocity(hand.joint_count), Eigen::Vector3d::Zero());
  return body.reducedInertia();
}

}  // namespace

LineGrid lineGrid(double period_s) {
  LineGrid grid;
  grid.period_s = period_s;
  grid.window = static_cast<int>(std::lround(kWindow_s / period_s));
  const int last = grid.window / 2 - 1;
  const double decades = std::log10(static_cast<double>(last));
  const int steps = static_cast<int>(std::ceil(decades * kLinesPerDecade));
  for (int i = 0; i <= steps; ++i) {
    const int line = static_cast<int>(std::lround(std::pow(10.0, decades * i / steps)));
    if (grid.lines.empty() || line > grid.lines.back()) grid.lines.push_back(line);
  }
  return grid;
}

LineGrid oneLine(double frequency_hz, double period_s) {
  constexpr int kTurns = 4;
  return {static_cast<int>(std::lround(kTurns / (frequency_hz * period_s))), period_s, {kTurns}};
}

LineTransform::LineTransform(const LineGrid& grid) : grid_(&grid), sum_(grid.lines.size()) {
  for (int k = 0; k < grid.window; ++k) {
    turn_.push_back(std::polar(1.0, -2.0 * std::numbers::pi * k / grid.window));
  }
}

void LineTransform::add(double sample) {
  const std::int64_t at = added_++ % grid_->window;
  for (std::size_t i = 0; i < sum_.size(); ++i) {
    const std::int64_t angle = at * grid_->lines[i] % grid_->window;
    sum_[i] += sample * turn_[angle];
  }
}

std::complex<double> LineTransform::phasor(std::size_t line) const {
  return sum_[line] * (2.0 / added_);
}

MultisinePlayer::MultisinePlayer(AxisPosition rest, int axis, const LineGrid& grid,
                                 const std::vector<double>& amplitude, double stiffness)
    : rest_(rest), axis_(axis), aim_(grid.window) {
  const auto count = static_cast<double>(grid.lines.size());
  for (std::size_t i = 0; i < grid.lines.size(); ++i) {
    // Schroeder phases keep the peaks of the sum low.
    const auto n = static_cast<double>(i);
    const double phase = -std::numbers::pi * n * (n + 1.0) / count;
    for (std::size_t k = 0; k < aim_.size(); ++k) {
      const auto turned = static_cast<std::int64_t>(k) * grid.lines[i] % grid.window;
      aim_[k] +=
          amplitude[i] / stiffness *
          std::sin(2.0 * std::numbers::pi * static_cast<double>(turned) / grid.window + phase);
    }
  }
}

void MultisinePlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  ++periods_;
  const double u = std::min(static_cast<double>(periods_) * period_s / kFade_s, 1.0);
  q = rest_;
  q[axis_] += u * u * (3.0 - 2.0 * u) * aim_[periods_ % aim_.size()];
  qd = AxisVelocity(rest_.size());
}

AxisPosition middleOf(const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) {
    const DeviceAxis& axis = device.axes[a];
    q[a] = 0.5 * (axis.lower + axis.upper);
  }
  return q;
}

PatientConfig armFor(const DeviceModel& device, int axis, double lowest_hz) {
  PatientConfig arm;
  for (const DeviceAxis& d : device.axes) {
    constexpr double kVice_rad_s = 1e4;
    arm.axes.push_back(
        {d.name, 0.0, 2.0 * d.mass * kVice_rad_s, d.mass * kVice_rad_s * kVice_rad_s});
  }
  // The arm's stiffness is a millionth of the device's inertial effort at the lowest line.
  const double lowest_rad_s = 2.0 * std::numbers::pi * lowest_hz;
  PatientAxis& pushed = arm.axes[axis];
  pushed.damping = 0.0;
  pushed.stiffness = 1e-6 * device.axes[axis].mass * lowest_rad_s * lowest_rad_s;
  return arm;
}

FeltLoop feltLoop(const ImpedanceBench& bench, int axis, double stiffness) {
  const CouplingGains& gains = bench.rig->gains;
  FeltLoop felt;
  felt.loop = axisLoop(bench.models.device, gains, axis, bench.grid.period_s);
  felt.loop.phi_k_dm *= bench.phi;
  felt.inertia = withArmature(bench.inertia, gains.armature);
  felt.loop.spring_per_s2 = stiffness / felt.inertia(axis, axis);
  felt.axis = axis;
  felt.k_pm = gains.k_pm;
  felt.avatar_damping = avatarDamping(felt.inertia, gains.k_pm, bench.grid.period_s);
  return felt;
}

double settleTime(const AxisLoop& loop, ContactCase contact) {
  const Eigen::VectorXcd found = poles(closedLoopMatrix(loop, contact));
  if (found.size() == 0) return -1.0;
  double slowest = 0.0;
  // A common drift of device and hand (eigenvalue 1) is constant and appears in no line.
  bool drift = contact != ContactCase::kFree;
  for (const std::complex<double>& pole : found) {
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

std::unique_ptr<PhysicsWorld> contactWorld(const ImpedanceBench& bench, int axis,
                                           ContactCase contact, double stiffness) {
  AnalyticScene scene;
  scene.gravity_m_s2 = bench.rig->renderer->config().gravity_m_s2;
  scene.axes.resize(bench.rest.size());
  AnalyticAxis& met = scene.axes[axis];
  const double period_s = bench.grid.period_s;
  if (contact == ContactCase::kRigid) {
    met.lower_stop = met.upper_stop = bench.rest[axis];
  } else {
    // Engines solve contacts after the step: M (v⁺ − v) = T (f − k (q + T v⁺)). In a world that
    // applies springs before the step this equals an added mass T²k and damping T k.
    met.stiffness = stiffness;
    met.damping = period_s * stiffness;
    met.added_mass = period_s * period_s * stiffness;
    met.spring_rest = bench.rest[axis];
  }
  return std::make_unique<AnalyticWorld>(bench.rig->models.hand, scene);
}

Expected<ImpedanceBench> makeImpedanceBench(const Models& models, double phi,
                                            const ImpedanceOptions& how, BenchDevice device) {
  ImpedanceBench bench;
  bench.phi = phi;
  bench.models = modelsFor(models, phi, device);
  bench.grid = lineGrid(how.period_s);
  bench.rest = middleOf(bench.models.device);
  bench.inertia = inertiaAt(bench.models.hand, bench.rest);
  Models own = bench.models;
  own.patient = armFor(own.device, 0, bench.grid.frequency_hz(0));
  RigOptions options;
  options.period_s = how.period_s;
  options.engine = how.engine;
  options.uncertified = true;  // the bench moves nobody
  auto player = std::make_unique<MultisinePlayer>(
      bench.rest, 0, bench.grid, std::vector<double>(bench.grid.lines.size(), 0.0), 1.0);
  auto rig = buildRig(std::move(own), std::move(player), options);
  if (!rig) return rig.errors();
  bench.rig = std::move(*rig);
  return bench;
}

namespace {

using Complex = std::complex<double>;

// Speed amplitude of the device per line: small enough to avoid saturation and changes of posture,
// large compared with rounding.
constexpr double kLineSpeed_m_s = 1e-4, kLineSpeed_rad_s = 1e-3;
// Lever arm that the certificate assumes for a rotation without one.
constexpr double kUsualLeverArm_m = 0.08;
constexpr int kFinePoints = 300;  // number of points of a predicted curve, which has sharp bends
// Amplitude and frequency of the measurement with dry friction: a typical hand speed at 1 Hz.
constexpr double kUsualSpeed_m_s = 0.1, kUsualSpeed_rad_s = 1.0, kUsual_hz = 1.0;

constexpr const char* kNeverSettles = "the loop does not settle by itself";

/// Reason why the tick was not linear on the axis; empty: it was linear.
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

/// Runs the renderer until it has settled, then records one window.
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
    // The push is linear between samples. `push` is the continuous sine with the same effect on the
    // device.
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

/// Measures one excitation in one world with a new renderer.
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
  if (!(other.decibel <= decibel)) decibel = other.decibel;  // NaN counts as the worst
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
