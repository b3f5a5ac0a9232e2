#include "lab/stiffness_trial.hpp"

#include "experiments/pushed_axis.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/dynamics/synergy.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/models.hpp"
#include "rig/rig.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

namespace wholehand {
namespace {

constexpr double kEnd_s = 4.0;
/// Windows after the knock: the motion in the first one is compared with that in the last one.
constexpr double kEarly_s = 2.1, kEarlyEnds_s = 2.6, kLate_s = 3.5;
/// Range of the search, in shares of the bound.
constexpr double kLow = 0.8, kHigh = 1.4;
constexpr int kHalvings = 6;
constexpr double kGap_m = 0.004;

/// Extent of the hand along −y [m].
double reachBackwards(const HandModel& hand, const AxisPosition& q_s) {
  ArticulatedBody body(hand);
  JointPosition theta;
  Synergy(hand).expand(q_s, theta);
  body.updateKinematics(theta);
  double furthest_m = -std::numeric_limits<double>::infinity();
  for (const Capsule& c : hand.capsules) {
    const Pose& at = body.linkPose(c.link);
    const Eigen::Vector3d a = at * c.a_m, b = at * c.b_m;
    furthest_m = std::max({furthest_m, c.radius_m - a.y(), c.radius_m - b.y()});
  }
  return furthest_m;
}

SceneBody boxBehind(double face_m) {
  SceneBody body;
  body.name = "box";
  body.fixed = true;
  body.pose.translation_m = {0.0, -face_m - 0.05, 0.0};
  Shape shape;
  shape.half_extents_m = {0.5, 0.05, 0.5};
  body.shapes.push_back(shape);
  return body;
}

/// Models of the trial before the stiffness is set, with its axis and posture.
struct Bench {
  Models models;
  int axis = 0;
  AxisPosition start;
};

Expected<Bench> makeBench(const ModelFiles& files) {
  auto models = loadModels(files);
  if (!models) return models.errors();
  Bench bench{std::move(*models), 0, {}};
  DeviceModel& device = bench.models.device;
  bench.axis = device.axisIndex("y");
  if (bench.axis < 0) {
    return Diagnostic{device.path, 0, "axes", "", "has no axis y to press with", "use another one"};
  }
  bench.start = AxisPosition(device.axisCount());
  if (const int fingers = device.axisIndex("finger_flexion"); fingers >= 0) {
    bench.start[fingers] = 1.0;  // only the back of the hand touches the box
  }
  device.output_delay_ticks = 1;
  DeviceAxis& axis = device.axes[static_cast<std::size_t>(bench.axis)];
  axis.mass = PushedAxis::kMass_kg;
  axis.damping = PushedAxis::kDamping_n_s_m;
  axis.effort_limit = 1e6;  // disables the limits
  axis.effort_slew_limit = 1e9;
  AxisRendering& gains = bench.models.rendering.axes[static_cast<std::size_t>(bench.axis)];
  gains.armature = 0.0;
  gains.gamma = gains.k_dm = 0.0;
  bench.models.scene.bodies = {boxBehind(reachBackwards(bench.models.hand, bench.start) + kGap_m)};
  return bench;
}

/// True when the motion after the knock decays.
Expected<bool> fades(const ModelFiles& files, double stiffness_n_m, const RigOptions& options) {
  auto bench = makeBench(files);
  if (!bench) return bench.errors();
  bench->models.rendering.axes[static_cast<std::size_t>(bench->axis)].k_pm = stiffness_n_m;
  auto device = std::make_unique<PushedAxis>(bench->start, bench->axis, options.period_s);
  const PushedAxis& pushed = *device;
  auto rig = buildRigWithoutPerson(std::move(bench->models), std::move(device), options);
  if (!rig) return rig.errors();
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();
  auto record = std::make_unique<TickRecord>();
  double early = 0.0, late = 0.0;
  for (std::uint64_t k = 0; static_cast<double>(k) * options.period_s < kEnd_s; ++k) {
    if (InterruptScope::interrupted()) break;
    record->tick = k;
    record->time_s = static_cast<double>(k) * options.period_s;
    (*rig)->renderer->tick(1, *record);
    const double squared = pushed.velocity() * pushed.velocity();
    if (record->time_s > kEarly_s && record->time_s <= kEarlyEnds_s) early += squared;
    if (record->time_s > kLate_s) late += squared;
  }
  return late < early;
}

}  // namespace

Expected<StableStiffness> largestStableStiffness(const ModelFiles& files, const std::string& engine,
                                                 double rate_hz) {
  RigOptions options;
  options.engine = engine;
  options.period_s = 1.0 / rate_hz;
  options.uncertified = true;  // the search goes beyond certified gains
  auto bench = makeBench(files);
  if (!bench) return bench.errors();
  const CertificateInput input = certificateInput(bench->models, options.period_s);
  StableStiffness out;
  out.bound_n_m = certifyAxis(axisCase(input, bench->axis)).rigid_limit;
  double low = kLow, high = kHigh;
  auto begun = fades(files, low * out.bound_n_m, options);
  if (!begun) return begun.errors();
  if (!*begun) return out;
  for (int i = 0; i < kHalvings && !InterruptScope::interrupted(); ++i) {
    const double middle = 0.5 * (low + high);
    auto stable = fades(files, middle * out.bound_n_m, options);
    if (!stable) return stable.errors();
    (*stable ? low : high) = middle;
  }
  out.found_n_m = low * out.bound_n_m;
  return out;
}

}  // namespace wholehand
