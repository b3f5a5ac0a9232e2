#include "experiments/grasp_trial.hpp"

#include "assembly/run.hpp"
#include "assembly/text_file.hpp"
#include "core/units.hpp"
#include "dynamics/articulated_body.hpp"
#include "experiments/grasp_script.hpp"
#include "runtime/interrupt_scope.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <utility>

namespace wholehand {
namespace {

constexpr double kDropped_m = 0.02;  // further off than this in the palm's frame: dropped
constexpr double kNoiseWindow_s = 2.0;

// Mean and spread without storing the samples (Welford).
class Spread {
 public:
  void add(double x) {
    ++count_;
    const double d = x - mean_;
    mean_ += d / count_;
    squares_ += d * (x - mean_);
  }
  [[nodiscard]] double rms() const { return count_ > 0 ? std::sqrt(squares_ / count_) : 0.0; }

 private:
  double count_ = 0.0, mean_ = 0.0, squares_ = 0.0;
};

// Watches the records of a trial and keeps what its result needs.
class GraspObserver {
 public:
  GraspObserver(const GraspTrial& trial, const Rig& rig, double hold_s)
      : rig_(rig),
        body_(rig.models.hand),
        end_s_(grasp_times::kHoldBegins + hold_s),
        noise_(static_cast<std::size_t>(rig.models.device.axisCount())) {
    result_.trial = trial;
  }

  void operator()(const TickRecord& r) {
    result_.coupling_error_rad = std::max(result_.coupling_error_rad, r.coupling_error_rad);
    if (any(r.faults & Fault::kEffortLimit)) ++result_.saturated_ticks;
    trackTipForce(r);
    if (r.time_s < grasp_times::kLiftBegins || r.time_s > end_s_) return;
    body_.updateKinematics(r.theta);
    const Pose palm = body_.linkPose(rig_.models.hand.palm_link);
    const Pose object{r.bodies[0].orientation_xyzw.eigen().toRotationMatrix(),
                      r.bodies[0].position_m.eigen()};
    const Pose held = palm.inverse() * object;
    if (!lifting_) {
      lifting_ = true;
      at_lift_ = held;
      world_at_lift_ = object.translation_m;
    }
    result_.object_travel_m = (object.translation_m - world_at_lift_).norm();
    result_.carry_shift_m =
        std::max(result_.carry_shift_m, (held.translation_m - at_lift_.translation_m).norm());
    if (r.time_s < grasp_times::kHoldBegins) return;
    trackHold(r, held);
  }

  GraspResult finish(const TickRecord& last) {
    for (const Spread& s : noise_) result_.force_noise_n = std::max(result_.force_noise_n, s.rms());
    result_.contact_residual = residual();
    for (int i = 0; i < last.contact_count; ++i) {
      result_.contact_force_n += last.contacts[static_cast<std::size_t>(i)].force_n.eigen().norm();
    }
    const bool carried = std::abs(result_.object_travel_m - kLift_m) < 0.1 * kLift_m;
    const bool stayed = result_.carry_shift_m < kDropped_m;  // false for NaN, too
    result_.dropped = !stayed || !carried || !holding_;
    return result_;
  }

 private:
  void trackTipForce(const TickRecord& r) {
    for (int a = 0; a < r.sent.size(); ++a) {
      const double arm = rig_.models.device.axes[static_cast<std::size_t>(a)].lever_arm_m;
      if (arm > 0.0) {
        result_.tip_force_max_n = std::max(result_.tip_force_max_n, std::abs(r.sent[a]) / arm);
      }
    }
  }

  void trackHold(const TickRecord& r, const Pose& held) {
    if (!holding_) {
      holding_ = true;
      at_hold_ = held;
    }
    result_.slip_m = std::max(result_.slip_m, (held.translation_m - at_hold_.translation_m).norm());
    const Eigen::Matrix3d turn = at_hold_.rotation.transpose() * held.rotation;
    result_.rotation_rad = Eigen::AngleAxisd(turn).angle();
    if (r.time_s < end_s_ - kNoiseWindow_s) return;
    for (int a = 0; a < r.coupling.size(); ++a) {
      const DeviceAxis& axis = rig_.models.device.axes[static_cast<std::size_t>(a)];
      double newton = r.coupling[a];
      if (axis.kind == AxisKind::kRotation)
        newton /= axis.lever_arm_m > 0.0 ? axis.lever_arm_m : kTipArm_m;
      noise_[static_cast<std::size_t>(a)].add(newton);
    }
    trackResidual(r);
  }

  // Virtual work: at rest the contact forces of this tick, seen by the person's coordinates,
  // balance what drives the avatar.
  void trackResidual(const TickRecord& r) {
    const int axes = r.f_s.size();
    std::array<double, kMaxAxes> felt{};
    std::array<double, kMaxAxes> row{};
    for (int i = 0; i < r.contact_count; ++i) {
      const Contact& c = r.contacts[static_cast<std::size_t>(i)];
      const Eigen::Vector3d f = c.force_n.eigen();
      body_.reducedPointRow(c.link, c.point_m.eigen(), f, row.data());
      for (int a = 0; a < axes; ++a)
        felt[static_cast<std::size_t>(a)] += row[static_cast<std::size_t>(a)];
      body_.reducedAngularRow(c.link, c.torque_nm.eigen(), row.data());
      for (int a = 0; a < axes; ++a)
        felt[static_cast<std::size_t>(a)] += row[static_cast<std::size_t>(a)];
    }
    addSelfForces(felt);
    if (unbalanced_.size() != axes) unbalanced_ = driving_ = AxisEffort(axes);
    for (int a = 0; a < axes; ++a) {
      unbalanced_[a] += felt[static_cast<std::size_t>(a)] + r.f_s[a];
      driving_[a] += r.f_s[a];
    }
    count_ += 1.0;
  }

  // Fingers that meet and joints at their ends bear their share.
  void addSelfForces(std::array<double, kMaxAxes>& felt) {
    SelfForces own;
    rig_.world->selfForces(own);
    std::array<double, kMaxAxes> row{};
    for (int i = 0; i < own.count; ++i) {
      const SelfForce& touch = own.touches[static_cast<std::size_t>(i)];
      for (const auto& [capsule, sign] :
           {std::pair{touch.capsule_a, 1.0}, {touch.capsule_b, -1.0}}) {
        const int link = rig_.models.hand.capsules[static_cast<std::size_t>(capsule)].link;
        body_.reducedPointRow(link, touch.point_m.eigen(), touch.force_n.eigen(), row.data());
        for (std::size_t a = 0; a < felt.size(); ++a) felt[a] += sign * row[a];
      }
    }
    for (int a = 0; a < own.joint_ends.size(); ++a) {
      felt[static_cast<std::size_t>(a)] += own.joint_ends[a];
    }
  }

  [[nodiscard]] double residual() const {
    double worst = unbalanced_.size() > 0 ? 0.0 : 1.0;
    for (int a = 0; a < unbalanced_.size(); ++a) {
      const double scale = std::max(std::abs(driving_[a]) / count_, leastScale(a));
      worst = std::max(worst, std::abs(unbalanced_[a]) / count_ / scale);
    }
    return worst;
  }

  // An axis that carries next to nothing is judged by what its kind carries.
  [[nodiscard]] double leastScale(int axis) const {
    const auto& axes = rig_.models.device.axes;
    const AxisKind kind = axes[static_cast<std::size_t>(axis)].kind;
    double largest = 0.0;
    for (int b = 0; b < driving_.size(); ++b) {
      if (axes[static_cast<std::size_t>(b)].kind != kind) continue;
      largest = std::max(largest, std::abs(driving_[b]) / count_);
    }
    return std::max(0.1 * largest, kind == AxisKind::kTranslation ? 0.1 : 0.01);
  }

  static constexpr double kTipArm_m = 0.08;  // an axis without a tip counts at a finger's lever arm
  const Rig& rig_;
  ArticulatedBody body_;
  double end_s_;
  GraspResult result_;
  std::vector<Spread> noise_;
  Pose at_lift_, at_hold_;
  Eigen::Vector3d world_at_lift_ = Eigen::Vector3d::Zero();
  bool lifting_ = false, holding_ = false;
  AxisEffort unbalanced_, driving_;  // sums over the last 2 s
  double count_ = 0.0;
};

GraspTrial posture(std::string shape, std::string grasp, const Eigen::Vector3d& center_mm,
                   double circ_deg, double open_deg, double fingers_deg, double thumb_deg) {
  return {std::move(shape), std::move(grasp),   false,           center_mm * 1e-3, circ_deg * kDeg,
          open_deg * kDeg,  fingers_deg * kDeg, thumb_deg * kDeg};
}

}  // namespace

std::string GraspTrial::name() const {
  return grasp + " " + shape + (gravity ? " under gravity" : " floating");
}

std::vector<GraspTrial> tunedTrials() {
  const std::vector<GraspTrial> floating = {
      posture("cube", "power", {49, 7, -40}, 75, 20, 152, 75),
      posture("sphere", "power", {57, 6, -44}, 75, 20, 160, 80),
      posture("cylinder", "power", {49, 4, -41}, 65, 20, 155, 55),
      posture("disk", "power", {65, 8, -51}, 80, 20, 130, 75),
      posture("sphere", "pinch", {69, 11, -68}, 75, 40, 122, 75),
      posture("cube", "pinch", {69, 11, -68}, 75, 40, 170, 75)};
  std::vector<GraspTrial> trials;
  for (bool gravity : {false, true}) {
    for (GraspTrial trial : floating) {
      trial.gravity = gravity;
      trials.push_back(trial);
    }
  }
  return trials;
}

std::vector<GraspTrial> jitteredTrials(int count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  // Not std::uniform_real_distribution: its values differ between standard libraries.
  const auto jitter = [&random](double half_width) {
    return half_width * (2.0 * static_cast<double>(random() >> 11U) * 0x1.0p-53 - 1.0);
  };
  const std::vector<GraspTrial> tuned = tunedTrials();
  std::vector<GraspTrial> trials;
  for (int i = 0; i < count; ++i) {
    GraspTrial trial = tuned[static_cast<std::size_t>(i) % tuned.size()];
    for (int axis = 0; axis < 3; ++axis) trial.center_m[axis] += jitter(3e-3);
    trial.circumduction_rad = std::min(trial.circumduction_rad + jitter(4 * kDeg), 90 * kDeg);
    trial.fingers_closed_rad = std::min(trial.fingers_closed_rad + jitter(6 * kDeg), 180 * kDeg);
    trial.thumb_closed_rad = std::min(trial.thumb_closed_rad + jitter(6 * kDeg), 80 * kDeg);
    trials.push_back(trial);
  }
  return trials;
}

Expected<GraspResult> runGrasp(const GraspTrial& trial, const ModelFiles& files,
                               const GraspPlan& plan) {
  // The scene becomes a file first: what is recorded is then all that is needed to run it again.
  auto models = loadModels(files);
  if (!models) return models.errors();
  ModelFiles with_scene = files;
  std::string stem = trial.name();
  std::replace(stem.begin(), stem.end(), ' ', '-');
  with_scene.scene = plan.folder + "/" + stem + ".toml";
  if (auto written = writeText(with_scene.scene, graspScene(trial, *models)); !written) {
    return written.errors();
  }
  models = loadModels(with_scene);
  if (!models) return models.errors();
  Intention intention = graspIntention(trial, *models);
  auto rig = buildRig(std::move(*models), std::move(intention), plan.rig);
  if (!rig) return rig.errors();
  if (auto armed = (*rig)->renderer->arm(); !armed) return armed.errors();

  GraspObserver observer(trial, **rig, plan.hold_s);
  TickRecord last;
  const double end_s = grasp_times::kHoldBegins + plan.hold_s;
  RunPlan run;
  run.title = "Grasping: " + trial.name();
  run.duration_ticks = static_cast<std::uint64_t>(std::llround(end_s / plan.rig.period_s));
  run.simulated_clock = true;
  run.interrupts = &InterruptScope::shared();
  if (plan.record) run.record = plan.folder + "/" + stem + ".h5";
  run.sinks.emplace_back([&](const TickRecord& record) {
    observer(record);
    if (record.time_s < end_s) last = record;
  });
  auto outcome = runAndRecord(**rig, run);
  if (!outcome) return outcome.errors();
  GraspResult result = observer.finish(last);
  result.faulted = outcome->faulted;
  result.dropped = result.dropped || outcome->faulted;
  result.interrupted = outcome->interrupted;
  result.cpu_p50_us = outcome->summary.cpu.p50_ns / 1e3;
  result.cpu_p999_us = outcome->summary.cpu.p999_ns / 1e3;
  return result;
}

}  // namespace wholehand
