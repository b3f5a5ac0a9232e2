#include "loop/physics/analytic/analytic_world.hpp"

#include "loop/dynamics/articulated_body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

namespace wholehand {

namespace {

/// Number of sweeps. Enough for the impulses of stops on axes that are coupled by inertia to
/// converge to the last digits.
constexpr int kSweeps = 60;

}  // namespace

AnalyticWorld::AnalyticWorld(const HandModel& hand, AnalyticScene scene)
    : hand_(&hand),
      scene_(std::move(scene)),
      synergy_(hand),
      body_(hand),
      q_s_(hand.reference),
      qd_s_(hand.axis_count),
      stop_effort_(hand.axis_count) {
  scene_.axes.resize(hand.axis_count);
  carrier_.resize(hand.axis_count);
  for (int a = 0; a < hand.axis_count; ++a) {
    for (int i = static_cast<int>(hand.links.size()) - 1; i >= 0; --i) {
      const HandLink& link = hand.links[i];
      if (link.joint < 0 || hand.synergy(link.joint, a) == 0.0) continue;
      carrier_[a] = {i, link.type == JointType::kRevolute};
    }
  }
  if (q_s_.size() != hand.axis_count) q_s_ = AxisPosition(hand.axis_count);
  setJoints();
}

void AnalyticWorld::setJoints() noexcept {
  synergy_.expand(q_s_, theta_);
  theta_dot_ = JointVelocity(hand_->joint_count);
  synergy_.expandRate(qd_s_.data(), theta_dot_.data());
}

Expected<Done> AnalyticWorld::placeHand(const AxisPosition& q_s) {
  Diagnostics errors;
  for (int a = 0; a < hand_->axis_count; ++a) {
    const AnalyticAxis& axis = scene_.axes[a];
    if (q_s[a] >= axis.lower_stop && q_s[a] <= axis.upper_stop) continue;
    errors.push_back(keyFault("", hand_->axis_names[a], std::to_string(q_s[a]),
                              "puts the hand inside a stop",
                              "must be in [" + std::to_string(axis.lower_stop) + ", " +
                                  std::to_string(axis.upper_stop) + "]"));
  }
  if (!errors.empty()) return errors;
  q_s_ = q_s;
  qd_s_ = AxisVelocity(hand_->axis_count);
  stop_effort_ = AxisEffort(hand_->axis_count);
  setJoints();
  return Done{};
}

Fault AnalyticWorld::observe(PhysicsState& state) noexcept {
  state.q_s = q_s_;
  state.qd_s = qd_s_;
  state.theta = theta_;
  state.theta_dot = theta_dot_;
  state.coupling_error_rad = 0.0;  // the joints are computed as θ₀ + G q_s, so there is no error
  state.body_count = 0;
  return allFinite(q_s_) && allFinite(qd_s_) ? Fault::kNone : Fault::kNonFiniteState;
}

void AnalyticWorld::placeBodies(const BodyPlacements&) noexcept {}

/// Reduced effort Gᵀτ plus the efforts of the springs.
AxisEffort AnalyticWorld::reducedEffort(const JointEffort& torque) const noexcept {
  AxisEffort out(hand_->axis_count);
  for (int a = 0; a < hand_->axis_count; ++a) {
    const AnalyticAxis& axis = scene_.axes[a];
    out[a] = -axis.stiffness * (q_s_[a] - axis.spring_rest) - axis.damping * qd_s_[a];
    for (int j = 0; j < hand_->joint_count; ++j) out[a] += hand_->synergy(j, a) * torque[j];
  }
  return out;
}

Fault AnalyticWorld::step(const HandDrive& drive, double period_s) noexcept {
  if (!body_.update(theta_, theta_dot_, scene_.gravity_m_s2)) return Fault::kPhysicsStep;
  AxisMatrix inertia = body_.reducedInertia();
  for (int a = 0; a < hand_->axis_count; ++a) inertia(a, a) += scene_.axes[a].added_mass;
  for (int a = 0; a < drive.armature.size(); ++a) inertia(a, a) += drive.armature[a];
  if (!invertPositiveDefinite(inertia, mobility_)) return Fault::kPhysicsStep;

  AxisEffort effort = reducedEffort(drive.torque);
  for (int a = 0; a < drive.armature.size(); ++a) effort[a] += drive.armature_effort[a];
  for (int a = 0; a < hand_->axis_count; ++a) {
    for (int b = 0; b < hand_->axis_count; ++b) {
      qd_s_[a] += period_s * mobility_(a, b) * (effort[b] - body_.reducedBias()[b]);
    }
  }
  holdAtStops(period_s);
  for (int a = 0; a < hand_->axis_count; ++a) q_s_[a] += period_s * qd_s_[a];
  setJoints();
  return allFinite(q_s_) ? Fault::kNone : Fault::kNonFiniteState;
}

/// Computes the impulses of the stops by projected Gauss-Seidel, as a contact solver does: within a
/// step a velocity may close a gap but not pass it, and a stop never pulls.
void AnalyticWorld::holdAtStops(double period_s) noexcept {
  std::array<double, kMaxAxes> impulse{};
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (int a = 0; a < hand_->axis_count; ++a) {
      const double fastest = (scene_.axes[a].upper_stop - q_s_[a]) / period_s;
      const double slowest = (scene_.axes[a].lower_stop - q_s_[a]) / period_s;
      // Without its own impulse the axis would move at `loose`; the stop adds only the missing
      // impulse.
      const double loose = qd_s_[a] - mobility_(a, a) * impulse[a];
      const double wanted = (std::clamp(loose, slowest, fastest) - loose) / mobility_(a, a);
      const double change = wanted - impulse[a];
      if (change == 0.0) continue;
      impulse[a] = wanted;
      for (int b = 0; b < hand_->axis_count; ++b) qd_s_[b] += mobility_(b, a) * change;
    }
  }
  for (int a = 0; a < hand_->axis_count; ++a) stop_effort_[a] = impulse[a] / period_s;
}

void AnalyticWorld::contacts(ContactList& contacts) const noexcept {
  contacts.count = 0;
  contacts.dropped = 0;
  for (int a = 0; a < hand_->axis_count; ++a) {
    if (stop_effort_[a] == 0.0) continue;
    const Carrier& carrier = carrier_[a];
    const HandLink& link = hand_->links[carrier.link];
    const Pose& pose = body_.linkPose(carrier.link);
    const Eigen::Vector3d axis = pose.rotation * link.axis;
    const double effort = stop_effort_[a] / hand_->synergy(link.joint, a);
    Contact& c = contacts.points[contacts.count++];
    c = Contact{};
    c.link = carrier.link;
    c.point_m = Vec3::from(pose.translation_m);
    c.normal = Vec3::from(effort > 0.0 ? axis : Eigen::Vector3d(-axis));
    (carrier.rotates ? c.torque_nm : c.force_n) = Vec3::from(effort * axis);
  }
}

void AnalyticWorld::selfForces(SelfForces& forces) const noexcept {
  forces.count = 0;
  forces.joint_ends = AxisEffort(hand_->axis_count);
}

}  // namespace wholehand
