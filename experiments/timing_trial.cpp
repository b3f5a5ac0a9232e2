#include "experiments/timing_trial.hpp"

#include "assembly/text_file.hpp"
#include "core/units.hpp"
#include "experiments/grasp_script.hpp"
#include "runtime/interrupt_scope.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

constexpr double kSway_m = 0.03;
constexpr double kTable_m = 0.12;   // wide enough for a cylinder that is put down a little askew
constexpr double kHolding_n = 5.0;  // a grasp; the swinging thumb brushes with less than 1 N
constexpr double kReleased_n = 1.0;

GraspTrial cylinder() {
  for (const GraspTrial& trial : tunedTrials()) {
    if (trial.shape == "cylinder" && trial.gravity) return trial;
  }
  return {};
}

// A pose of the six coordinates; axes that a device does not have are left out.
AxisPosition poseOf(const DeviceModel& device, const Eigen::Vector3d& base, double fingers,
                    double circumduction, double thumb) {
  AxisPosition q(device.axisCount());
  const auto set = [&](const char* axis, double value) {
    if (const int a = device.axisIndex(axis); a >= 0) q[a] = value;
  };
  set("x", base.x());
  set("y", base.y());
  set("z", base.z());
  set("finger_flexion", fingers);
  set("thumb_circumduction", circumduction);
  set("thumb_flexion", thumb);
  return q;
}

// Approach once; then again and again: close, carry the cylinder about on all three axes, bring it
// back, open.
Intention timingIntention(const GraspTrial& trial, const Models& models, double duration_s) {
  constexpr double kCycle_s = 5.0;
  const Eigen::Vector3d base = graspBase(models.device);
  const double opposed = trial.circumduction_rad, less = opposed - 8 * kDeg;
  const double open = trial.fingers_open_rad, closed = trial.fingers_closed_rad;
  const double thumb = trial.thumb_closed_rad;
  std::vector<Waypoint> waypoints;
  const auto add = [&](double time_s, const Eigen::Vector3d& at, double fingers, double turn,
                       double bent) {
    waypoints.push_back({time_s, poseOf(models.device, at, fingers, turn, bent)});
  };
  add(0.0, base + graspApproach(models), open, kApproachCircumduction_rad, 0.0);
  add(1.0, base, open, kApproachCircumduction_rad, 0.0);
  const Eigen::Vector3d left = base + Eigen::Vector3d(-kSway_m, -kSway_m, 2 * kSway_m);
  const Eigen::Vector3d right = base + Eigen::Vector3d(kSway_m, kSway_m, 2 * kSway_m);
  for (double start_s = 1.0; start_s < duration_s; start_s += kCycle_s) {
    add(start_s + 0.8, base, open, opposed, 0.0);
    add(start_s + 1.8, base, closed, opposed, thumb);
    add(start_s + 2.6, left, closed, opposed, thumb);
    add(start_s + 3.4, right, closed, less, thumb);
    add(start_s + 4.2, base, closed, opposed, thumb);
    add(start_s + kCycle_s, base, open, less, 0.0);
  }
  return Intention::throughWaypoints(std::move(waypoints));
}

// Counts what the records say, off the real-time thread.
class TimingObserver {
 public:
  explicit TimingObserver(TimingResult& result, int joints) : result_(result) {
    result_.wall_counts.assign(kTimingBins, 0);
    result_.cpu_counts.assign(kTimingBins, 0);
    lowest_.assign(static_cast<std::size_t>(joints), std::numeric_limits<double>::infinity());
    highest_.assign(static_cast<std::size_t>(joints), -std::numeric_limits<double>::infinity());
  }

  void operator()(const TickRecord& r) {
    ++result_.wall_counts[bin(r.wall_ns)];
    ++result_.cpu_counts[bin(r.cpu_ns)];
    double grip_n = 0.0;
    for (int i = 0; i < r.contact_count; ++i) {
      grip_n += r.contacts[static_cast<std::size_t>(i)].force_n.eigen().norm();
    }
    if (!holding_ && grip_n > kHolding_n) {
      holding_ = true;
      ++result_.grasps;
    } else if (holding_ && grip_n < kReleased_n) {
      holding_ = false;
      ++result_.releases;
    }
    for (int j = 0; j < r.theta.size(); ++j) {
      const auto k = static_cast<std::size_t>(j);
      lowest_[k] = std::min(lowest_[k], r.theta[j]);
      highest_[k] = std::max(highest_[k], r.theta[j]);
    }
  }

  void finish() {
    for (std::size_t j = 0; j < lowest_.size(); ++j) {
      result_.joint_travel.push_back(highest_[j] - lowest_[j]);
    }
  }

 private:
  static std::size_t bin(std::int64_t ns) {
    const double us = static_cast<double>(ns) / 1e3;
    return static_cast<std::size_t>(std::clamp(us / kTimingBin_us, 0.0, kTimingBins - 1.0));
  }

  TimingResult& result_;
  std::vector<double> lowest_, highest_;
  bool holding_ = false;
};

}  // namespace

Expected<TimingResult> runTiming(const ModelFiles& files, const TimingPlan& plan) {
  const GraspTrial trial = cylinder();
  auto models = loadModels(files);
  if (!models) return models.errors();
  ModelFiles with_scene = files;
  with_scene.scene = plan.folder + "/timing-cylinder.toml";
  if (auto written = writeText(with_scene.scene, graspScene(trial, *models, kTable_m)); !written) {
    return written.errors();
  }
  models = loadModels(with_scene);
  if (!models) return models.errors();
  const RigOptions options;
  Intention intention =
      timingIntention(trial, *models, static_cast<double>(plan.ticks) * options.period_s);
  auto rig = buildRig(std::move(*models), std::move(intention), options);
  if (!rig) return rig.errors();
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();

  TimingResult result;
  TimingObserver observer(result, (*rig)->models.hand.joint_count);
  RunPlan run;
  run.title = "Timing: a cylinder grasped, released and grasped again";
  run.duration_ticks = plan.ticks;
  run.simulated_clock = plan.simulated_clock;
  run.interrupts = &InterruptScope::shared();
  run.count_allocations = plan.count_allocations;
  run.record = plan.folder + "/timing.h5";
  run.status = plan.status;
  run.sinks.emplace_back([&](const TickRecord& record) { observer(record); });
  auto outcome = runAndRecord(**rig, run);
  if (!outcome) return outcome.errors();
  result.outcome = std::move(*outcome);
  observer.finish();
  return result;
}

}  // namespace wholehand
