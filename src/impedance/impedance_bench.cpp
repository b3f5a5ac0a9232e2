#include "impedance/impedance_bench.hpp"

#include "dynamics/articulated_body.hpp"
#include "dynamics/synergy.hpp"
#include "physics/analytic/analytic_world.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kWindow_s = 10.0;  // one period of the lowest line
constexpr double kLinesPerDecade = 14.0;
constexpr double kFade_s = 0.5;  // a gradual onset leaves a smaller transient

constexpr double kLeastSettle_s = 1.5, kMostSettle_s = 60.0;
constexpr double kLeftOfTransient = 1e-7;

/// Fixes Φ at 0 or 1 by thresholds that no effort, or every effort, exceeds.
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
  // A millionth of the device's inertial effort at the lowest line.
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
  // A joint drift of device and hand (eigenvalue 1) is a constant, which no line contains.
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
  options.uncertified = true;  // no person is moved
  auto player = std::make_unique<MultisinePlayer>(
      bench.rest, 0, bench.grid, std::vector<double>(bench.grid.lines.size(), 0.0), 1.0);
  auto rig = buildRig(std::move(own), std::move(player), options);
  if (!rig) return rig.errors();
  bench.rig = std::move(*rig);
  return bench;
}

}  // namespace wholehand
