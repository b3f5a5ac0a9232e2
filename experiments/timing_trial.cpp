#include "experiments/timing_trial.hpp"

#include "experiments/exercise_script.hpp"
#include "experiments/grip_target.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/rig.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

// Least force of a grasp; the swinging thumb touches with less than 1 N.
constexpr double kHolding_n = 5.0;
constexpr double kReleased_n = 1.0;

// Evaluates the records outside the real-time thread.
class TimingObserver {
 public:
  explicit TimingObserver(TimingResult& result, int body, int joints)
      : result_(result), body_(body) {
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
      const Contact& c = r.contacts[i];
      if (c.body == body_) grip_n += c.force_n.eigen().norm();
    }
    if (!holding_ && grip_n > kHolding_n) {
      holding_ = true;
      ++result_.grasps;
    } else if (holding_ && grip_n < kReleased_n) {
      holding_ = false;
      ++result_.releases;
    }
    if (holding_) held_.add(r.cpu_ns);
    if (r.exercise.alpha > 0.0) ++result_.wall_ticks;
    for (int j = 0; j < r.theta.size(); ++j) {
      lowest_[j] = std::min(lowest_[j], r.theta[j]);
      highest_[j] = std::max(highest_[j], r.theta[j]);
    }
  }

  void finish() {
    result_.held_ticks = held_.count();
    result_.held_cpu = held_.percentiles();
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
  int body_;
  std::vector<double> lowest_, highest_;
  bool holding_ = false;
  DurationHistogram held_;
};

}  // namespace

Expected<TimingResult> runTiming(const TimingPlan& plan) {
  auto models = loadModels(plan.files);
  if (!models) return models.errors();
  const GripTarget target = models->exercise ? firstDispenser(*models) : firstBody(*models);
  if (target.body < 0) {
    const bool bar = models->exercise != nullptr;
    return fileFault(bar ? plan.files.exercise : plan.files.scene, "has nothing to grip",
                     bar ? "give the file of a cocktail bar" : "give a scene with a body in it");
  }
  TimingResult result;
  result.gripped = models->scene.bodies[target.body].name;
  RigOptions options;
  options.engine = plan.engine;
  Intention intention = squeezeAgainAndAgain(models->device, target.grip_m,
                                             static_cast<double>(plan.ticks) * options.period_s);
  auto rig = buildRig(std::move(*models), std::move(intention), options);
  if (!rig) return rig.errors();

  TimingObserver observer(result, target.body, (*rig)->models.hand.joint_count);
  RunPlan run;
  run.title = "Timing: " + result.gripped + " grasped, released and grasped again";
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
