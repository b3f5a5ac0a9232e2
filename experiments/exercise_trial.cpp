#include "experiments/exercise_trial.hpp"

#include "experiments/bar_figures.hpp"
#include "experiments/exercise_script.hpp"
#include "experiments/grip_target.hpp"
#include "loop/dynamics/articulated_body.hpp"
#include "loop/runtime/interrupt_scope.hpp"
#include "rig/run/run.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

/// Sorts contacts by the touching part of the hand and stores the data of the figure.
class ExerciseObserver {
 public:
  ExerciseObserver(const Rig& rig, const BarFigures& figures, int dispenser, ExerciseResult& result)
      : rig_(rig),
        figures_(figures),
        dispenser_(dispenser),
        result_(result),
        body_(rig.models.hand),
        step_done_(figures.event("step_done")) {
    const auto& axes = rig.models.device.axes;
    for (const DeviceAxis& axis : axes) {
      result_.axis_names.push_back(axis.name);
      result_.lever_arms_m.push_back(axis.lever_arm_m);
    }
    result_.phi_peak = AxisRatio(static_cast<int>(axes.size()));
  }

  void operator()(const TickRecord& r) {
    ExerciseSample s;
    s.time_s = r.time_s;
    s.sent = r.sent;
    s.wall = r.exercise.effort;
    s.phi = r.phi;
    s.alpha = r.exercise.alpha;
    s.palm_m = std::abs(r.palm_target_distance_m);
    s.squeeze_n = figures_(BarFigures::kSqueeze, r.exercise);
    s.flow_l_s = figures_(BarFigures::kFlow, r.exercise);
    s.glass_l = figures_(BarFigures::kGlass, r.exercise);
    sortContacts(r, s);
    keep(r, s);
    result_.samples.push_back(s);
  }

  [[nodiscard]] bool served() const { return served_; }

 private:
  void sortContacts(const TickRecord& r, ExerciseSample& s) {
    body_.updateKinematics(r.theta);
    for (int i = 0; i < r.contact_count; ++i) {
      const Contact& c = r.contacts[i];
      if (c.body != dispenser_) continue;
      const HandPart part = rig_.models.hand.capsules[c.capsule].part;
      const double normal_n = c.force_n.eigen().dot(c.normal.eigen());
      const bool palm = part == HandPart::kPalm, thumb = part == HandPart::kThumb;
      (palm ? s.palm_n : thumb ? s.thumb_n : s.fingers_n) += normal_n;
      // Link frames: z dorsal; the normal points from the body to the hand.
      const Eigen::Vector3d dorsal = body_.linkPose(c.link).rotation.col(2);
      const bool back = dorsal.dot(c.normal.eigen()) < -0.5;
      if (back && !palm && !thumb) s.dorsal_n += normal_n;
    }
  }

  void keep(const TickRecord& r, const ExerciseSample& s) {
    for (int a = 0; a < r.phi.size(); ++a) {
      result_.phi_peak[a] = std::max(result_.phi_peak[a], r.phi[a]);
      const double arm_m = result_.lever_arms_m[a];
      const double effort = r.exercise.effort[a] / (arm_m > 0.0 ? arm_m : 1.0);
      // Closing increases the coordinate.
      result_.wall_pull_max_n = std::max(result_.wall_pull_max_n, effort);
      result_.wall_push_max_n = std::max(result_.wall_push_max_n, -effort);
    }
    result_.alpha_max = std::max(result_.alpha_max, s.alpha);
    result_.squeeze_max_n = std::max(result_.squeeze_max_n, s.squeeze_n);
    result_.spilt_l = figures_(BarFigures::kSpilt, r.exercise);
    result_.volume_error_l = std::max(result_.volume_error_l, figures_.volumeError_l(r.exercise));
    for (int i = 0; i < r.exercise.event_count; ++i) {
      const ExerciseEvent& event = r.exercise.events[i];
      if (event.type != step_done_ || served_) continue;
      served_ = true;
      result_.poured_l = event.value;
    }
    if (served_) return;
    result_.asked_l = figures_(BarFigures::kAsked, r.exercise);
    result_.tolerance_l = figures_(BarFigures::kTolerance, r.exercise);
  }

  const Rig& rig_;
  const BarFigures& figures_;
  int dispenser_;
  ExerciseResult& result_;
  ArticulatedBody body_;
  int step_done_;
  bool served_ = false;
};

// Evaluates the samples.
void assess(ExerciseResult& result, bool served) {
  const auto phases = findPhases(result.samples);
  if (phases) {
    result.phases.assign(phases->begin(), phases->end());
    result.bumps = findBumps(result.samples, phases->front());
  }
  for (int a = 0; a < result.phi_peak.size(); ++a) {
    result.fading_s.push_back(fadingTime_s(result.samples, result.bumps, a));
  }
  const bool right = std::abs(result.poured_l - result.asked_l) <= result.tolerance_l;
  result.completed = phases && served && right && !(result.spilt_l > 0.0) && !result.faulted &&
                     !result.interrupted;
}

}  // namespace

Expected<ExerciseResult> runExercise(const ExercisePlan& plan) {
  ModelFiles files = plan.files;
  files.level = 1;
  auto models = loadModels(files);
  if (!models) return models.errors();
  if (!models->exercise) return fileFault(files.exercise, "no exercise was named", "name one");
  const BarFigures figures(models->exercise->description());
  const GripTarget dispenser = firstDispenser(*models);
  if (!figures.known() || dispenser.body < 0) {
    return fileFault(files.exercise, "has no dispenser to squeeze",
                     "give the file of a cocktail bar");
  }
  if (models->device.axisIndex("finger_flexion") < 0) {
    return fileFault(files.device, "moves no fingers, and the exercise is squeezing",
                     "give a device with the axis finger_flexion");
  }
  Intention intention = exerciseIntention(models->device, dispenser.grip_m, plan.seed);
  auto rig = buildRig(std::move(*models), std::move(intention), plan.rig);
  if (!rig) return rig.errors();

  ExerciseResult result;
  ExerciseObserver observe(**rig, figures, dispenser.body, result);
  RunPlan run;
  run.title = "Exercise: bump, approach, squeeze, release";
  run.seed = plan.seed;
  run.duration_ticks =
      static_cast<std::uint64_t>(std::llround(exercise_times::kEnd / plan.rig.period_s));
  run.simulated_clock = true;
  run.interrupts = &InterruptScope::shared();
  run.record = plan.record;
  run.sinks.emplace_back([&](const TickRecord& record) {
    if (record.time_s >= exercise_times::kEnd) return;  // only the ramp to neutral follows
    observe(record);
  });
  auto outcome = runAndRecord(**rig, run);
  if (!outcome) return outcome.errors();
  result.faulted = outcome->faulted;
  result.interrupted = outcome->interrupted;
  assess(result, observe.served());
  return result;
}

}  // namespace wholehand
