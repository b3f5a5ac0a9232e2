#pragma once

#include "loop/device/simulated/simulated_device.hpp"
#include "loop/fault_injection/pushing_exercise.hpp"
#include "loop/physics/analytic/analytic_world.hpp"
#include "loop/renderer/safety_tools.hpp"
#include "support/accepting_device.hpp"
#include "support/fault_injector.hpp"
#include "support/faulty_world.hpp"

#include <optional>

/// A whole tick that is cheap enough for tens of thousands of faults, and the checks that hold for
/// each of them.
namespace wholehand::test {

/// The faults of one run: any of the three kinds.
struct Sabotage {
  std::vector<InjectedFault> device;
  InjectedWorldFault world{InjectedWorldFault::Kind::kStepFails, -1, 0};
  Push push = Push::kWell;
  int push_tick = 0, push_axis = 0;
};

/// A device's models and the parts of its renderer, loaded once.
struct Workbench {
  explicit Workbench(const std::string& device, const std::string& hand = "adult-median-right",
                     double of_period_s = kPeriod_s)
      : period_s(of_period_s) {
    Models m = withWeight(load(shippedFiles(device, "empty", hand, "stiff-adult")));
    auto simulated = std::make_unique<SimulatedDevice>(
        m.device, m.patient, Intention::throughWaypoints({{0.0, clear(m.device)}}), period_s);
    // The device is not declared as simulated, so everything is monitored.
    inner = std::move(simulated);
    RigOptions options;
    options.period_s = period_s;
    rig = build(std::move(m), std::make_unique<FaultInjector>(*inner, std::vector<InjectedFault>{}),
                options);
  }
  [[nodiscard]] const Models& models() const { return rig->models; }
  [[nodiscard]] const RendererConfig& config() const { return rig->renderer->config(); }
  [[nodiscard]] int axes() const { return models().device.axisCount(); }

  double period_s;
  std::unique_ptr<HapticDevice> inner;
  std::unique_ptr<Rig> rig;
};

inline const Workbench& workbench() {
  static const Workbench bench("lambda-pride");
  return bench;
}

/// A position off every stop, so that a stuck encoder differs from a hand that rests at a stop.
inline AxisPosition inside(const DeviceModel& device) {
  AxisPosition q(device.axisCount());
  for (int a = 0; a < q.size(); ++a) {
    q[a] = std::lerp(device.axes[a].lower, device.axes[a].upper, 0.4);
  }
  return q;
}

/// One run: a stiff person slams the device about against a rigid stop halfway along the first axis
/// while an exercise pushes.
struct Bench {
  Bench(const Workbench& workbench, const Sabotage& sabotage, std::mt19937_64& random,
        const RendererConfig& config)
      : simulated(
            workbench.models().device, workbench.models().patient,
            slamming(workbench.models().device, random, inside(workbench.models().device), 0.4),
            workbench.period_s),
        accepting(simulated, config.safety.neutral),
        device(accepting, sabotage.device),
        analytic(workbench.models().hand, stopOnFirst(workbench.models().hand.axis_count)),
        world(analytic, sabotage.world),
        exercise(config.safety.effort_limit, sabotage.push, sabotage.push_tick, sabotage.push_axis),
        renderer(device, world, workbench.models().hand, withABall(), config, &exercise) {}

  static SceneModel withABall() {
    SceneModel scene;
    scene.bodies = {ball({}, 0.03, 0.1)};
    return scene;
  }
  static AnalyticScene stopOnFirst(int axes) {
    AnalyticScene scene;
    scene.axes.resize(static_cast<std::size_t>(axes));
    scene.axes[0].upper_stop = 0.0;
    return scene;
  }

  const TickRecord& tick() {
    record.tick = static_cast<std::uint64_t>(++ticks);
    renderer.tick(device.nextElapsedPeriods(), record);
    record.command_count = 0;
    // The checks use what the device holds, not what the loop has requested.
    EXPECT_TRUE(same(record.sent, accepting.held())) << "tick " << ticks;
    return record;
  }

  SimulatedDevice simulated;
  AcceptingDevice accepting;
  FaultInjector device;
  AnalyticWorld analytic;
  FaultyWorld world;
  PushingExercise exercise;
  HapticRenderer renderer;
  TickRecord record;
  int ticks = -1;
};

/// Checks that every effort sent is allowed. Reports the first violation.
class Witness {
 public:
  explicit Witness(const RendererConfig& config) : config_(config), last_(config.safety.neutral) {}

  void onRecord(const TickRecord& r) {
    double power_w = 0.0;
    for (int a = 0; a < r.sent.size(); ++a) {
      const double change = std::abs(r.sent[a] - last_[a]);
      if (!std::isfinite(r.sent[a])) complain(r, a, "not finite", r.sent[a]);
      if (change > config_.safety.supervisor.most_change[a] + 1e-12)
        complain(r, a, "steep", change);
      if (std::abs(r.sent[a]) > config_.safety.effort_limit[a] + 1e-9)
        complain(r, a, "large", r.sent[a]);
      steepest = std::max(steepest, change / config_.safety.supervisor.most_change[a]);
      power_w += std::max((r.sent[a] - config_.safety.neutral[a]) * r.qd_mf[a], 0.0);
    }
    // The slew limit has priority: power falls no faster than it lets the efforts fall.
    if (power_w > config_.safety.supervisor.power_limit_w + 1e-9 &&
        !any(r.faults & (Fault::kEffortSlew | kStoppingFaults)) && r.authority == 1.0) {
      complain(r, -1, "powerful", power_w);
    }
    last_ = r.sent;
  }
  /// Checks that after a stop efforts only fall towards neutral.
  void onFallingRecord(const TickRecord& r) {
    for (int a = 0; a < r.sent.size(); ++a) {
      const double before = std::abs(last_[a] - config_.safety.neutral[a]);
      const double now = std::abs(r.sent[a] - config_.safety.neutral[a]);
      if (now > before + 1e-12) complain(r, a, "rising", now - before);
    }
    onRecord(r);
  }
  [[nodiscard]] const std::string& problem() const { return problem_; }
  [[nodiscard]] bool atNeutral() const {
    return std::memcmp(last_.data(), config_.safety.neutral.data(),
                       sizeof(double) * last_.size()) == 0;
  }
  double steepest = 0.0;  ///< largest change of an effort, in slew limits

 private:
  void complain(const TickRecord& r, int axis, const char* what, double value) {
    if (!problem_.empty()) return;
    problem_ = "tick " + std::to_string(r.tick) + ", axis " + std::to_string(axis) +
               ": effort is " + what + ", " + std::to_string(value);
  }
  const RendererConfig& config_;
  AxisEffort last_;
  std::string problem_;
};

}  // namespace wholehand::test
