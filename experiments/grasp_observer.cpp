#include "experiments/grasp_observer.hpp"

#include "experiments/grasp_script.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

// An object that shifts more than this in the palm's frame counts as dropped.
constexpr double kDropped_m = 0.02;
constexpr double kNoiseWindow_s = 2.0;

}  // namespace

GraspObserver::GraspObserver(const GraspTrial& trial, const Rig& rig, double hold_s)
    : rig_(rig),
      body_(rig.models.hand),
      balance_(rig),
      noise_(rig.models.device),
      end_s_(grasp_times::kHoldBegins + hold_s) {
  result_.trial = trial;
}

void GraspObserver::operator()(const TickRecord& r) {
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

GraspResult GraspObserver::finish(const TickRecord& last) {
  result_.force_noise_n = noise_.worst();
  result_.contact_residual = balance_.driveError();
  result_.felt_error = balance_.feltError();
  for (int i = 0; i < last.contact_count; ++i) {
    result_.contact_force_n += last.contacts[i].force_n.eigen().norm();
  }
  const bool carried = std::abs(result_.object_travel_m - kLift_m) < 0.1 * kLift_m;
  const bool stayed = result_.carry_shift_m < kDropped_m;  // false for NaN as well
  result_.dropped = !stayed || !carried || !holding_;
  return result_;
}

void GraspObserver::trackTipForce(const TickRecord& r) {
  for (int a = 0; a < r.sent.size(); ++a) {
    const double arm = rig_.models.device.axes[a].lever_arm_m;
    if (arm > 0.0) {
      result_.tip_force_max_n = std::max(result_.tip_force_max_n, std::abs(r.sent[a]) / arm);
    }
  }
}

void GraspObserver::trackHold(const TickRecord& r, const Pose& held) {
  if (!holding_) {
    holding_ = true;
    at_hold_ = held;
  }
  result_.slip_m = std::max(result_.slip_m, (held.translation_m - at_hold_.translation_m).norm());
  const Eigen::Matrix3d turn = at_hold_.rotation.transpose() * held.rotation;
  result_.rotation_rad = Eigen::AngleAxisd(turn).angle();
  if (r.time_s < end_s_ - kNoiseWindow_s) return;
  noise_.add(r);
  balance_.add(r, body_);
}

}  // namespace wholehand
