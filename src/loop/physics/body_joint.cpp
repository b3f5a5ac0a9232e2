#include "loop/physics/body_joint.hpp"

#include "loop/model/scene_model.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {

using Eigen::Vector3d;

namespace {

// A joint whose viscous friction takes a larger share of its rate in a step does not swing.
constexpr double kSwings = 0.1;
constexpr int kMostWaySteps = 8;  // of Newton's method in an untouched step; two or three are usual
constexpr double kExactWay = 4e-15;  // tolerance of its way

double sinc(double x) noexcept {
  return std::abs(x) < 1e-4 ? 1.0 - x * x / 6.0 : std::sin(x) / x;
}

}  // namespace

BodyJoint::BodyJoint(const SceneBody& body)
    : joint_(*body.joint),
      start_(body.pose),
      axis_(body.pose.rotation * body.joint->axis),
      arm_m_(body.pose.rotation * (body.com_m - body.joint->point_m)),
      mass_kg_(body.mass_kg),
      inertia_(body.mass_kg) {
  if (!joint_.isHinge()) return;
  const Vector3d about = start_.rotation.transpose() * axis_;
  inertia_ = about.dot(body.inertia_kg_m2 * about) + mass_kg_ * axis_.cross(arm_m_).squaredNorm();
}

BodyJoint::Twist BodyJoint::twist() const noexcept {
  if (!joint_.isHinge()) return {axis_, Vector3d::Zero()};
  return {axis_.cross(Eigen::AngleAxisd(q_, axis_) * arm_m_), axis_};
}

BodyJoint::Weight BodyJoint::weightAt(const Vector3d& gravity_m_s2) const noexcept {
  const Vector3d along = twist().linear;
  Weight weight{mass_kg_ * gravity_m_s2.dot(along)};
  if (joint_.isHinge()) weight.slope = mass_kg_ * gravity_m_s2.dot(axis_.cross(along));
  return weight;
}

// −(V(q + way) − V(q)) / way, in a form without cancellation.
double BodyJoint::meanForce(const Weight& weight, double way) const noexcept {
  const double half = 0.5 * way;
  double force = weight.force;
  if (joint_.isHinge()) {
    force = (weight.force * std::cos(half) + weight.slope * std::sin(half)) * sinc(half);
  }
  if (joint_.latch_energy_j > 0.0) {
    const double phase = joint_.latch_wave * (q_ + half - joint_.latch_at);
    force -= 0.5 * joint_.latch_energy_j * joint_.latch_wave * std::sin(phase) *
             sinc(joint_.latch_wave * half);
  }
  return force - joint_.spring_stiffness * (q_ + half - joint_.spring_rest);
}

// V″ in the middle of the way.
double BodyJoint::slopeOnWay(const Weight& weight, double way) const noexcept {
  const double half = 0.5 * way;
  double slope = joint_.spring_stiffness;
  if (joint_.isHinge()) slope += weight.force * std::sin(half) - weight.slope * std::cos(half);
  if (joint_.latch_energy_j > 0.0) {
    const double phase = joint_.latch_wave * (q_ + half - joint_.latch_at);
    slope += 0.5 * joint_.latch_energy_j * joint_.latch_wave * joint_.latch_wave * std::cos(phase);
  }
  return slope;
}

// The slope k that makes a touched step passive: V(q + d) − V(q) <= V′ d + k d² for every way d
// that the step can take (ADR 91).
double BodyJoint::stiffness(const Weight& weight, double most_weight,
                            double step_s) const noexcept {
  const double slope = slopeOnWay(weight, 0.0);
  const double wave = joint_.latch_wave;
  const double latch = 0.5 * joint_.latch_energy_j * wave * wave;
  const double bend = most_weight + latch * wave;  // largest |V‴|
  double least = std::max(0.0, 0.5 * slope + step_s * bend * std::abs(rate_) / 3.0);
  if (8.0 * step_s * step_s * (most_weight + latch) > inertia_) {
    least = std::max(least, 0.5 * (joint_.spring_stiffness + most_weight + latch));
  }
  return std::max(least, slope);
}

// m_q (q̇' − q̇) / T = mean force − c · mean rate − dry friction, with T · mean rate = way. False
// where that is not the law: the joint stops or meets an end in this step, or friction rules.
bool BodyJoint::swing(const Weight& weight, double force, double step_s) noexcept {
  if (step_s * joint_.viscous_friction > kSwings * inertia_) return false;
  if (joint_.dry_friction > 0.0 && rate_ == 0.0) return false;
  const double rub = std::copysign(joint_.dry_friction, rate_);
  const double per_way = 2.0 * inertia_ / (step_s * step_s) + joint_.viscous_friction / step_s;
  const double from = 2.0 * inertia_ * rate_ / step_s - rub;
  double way = step_s * rate_;
  const double scale = std::abs(way) + std::abs(force) / per_way;
  bool found = false;
  for (int i = 0; i < kMostWaySteps && !found; ++i) {
    const double off = from + meanForce(weight, way) - per_way * way;
    const double change = off / (per_way + 0.5 * slopeOnWay(weight, way));
    way += change;
    found = std::abs(change) <= kExactWay * (scale + std::abs(way));
  }
  next_q_ = q_ + way;
  if (!found || !(next_q_ >= joint_.least && next_q_ <= joint_.most)) return false;
  if (joint_.dry_friction > 0.0 && way * rub <= 0.0) return false;
  rate_ = 2.0 * way / step_s - rate_;
  return true;
}

void BodyJoint::predict(const Vector3d& gravity_m_s2, double step_s, bool touched) noexcept {
  const Weight weight = weightAt(gravity_m_s2);
  const double latch = 0.5 * joint_.latch_energy_j * joint_.latch_wave;
  const double force = weight.force - latch * std::sin(joint_.latch_wave * (q_ - joint_.latch_at)) -
                       joint_.spring_stiffness * (q_ - joint_.spring_rest);
  load_is_held_ = std::abs(force) <= joint_.dry_friction || (q_ <= joint_.least && force < 0.0) ||
                  (q_ >= joint_.most && force > 0.0);
  untouched_ = !touched && swing(weight, force, step_s);
  if (untouched_) {
    yield_ = 1.0 / inertia_;
    friction_impulse_ = 0.0;
    least_rate_ = -std::numeric_limits<double>::infinity();
    most_rate_ = std::numeric_limits<double>::infinity();
    return;
  }
  const double most_weight =
      joint_.isHinge() ? mass_kg_ * gravity_m_s2.norm() * axis_.cross(arm_m_).norm() : 0.0;
  yield_ = 1.0 / (inertia_ + step_s * joint_.viscous_friction +
                  step_s * step_s * stiffness(weight, most_weight, step_s));
  rate_ = yield_ * (inertia_ * rate_ + step_s * force);
  friction_impulse_ = joint_.dry_friction * step_s;
  least_rate_ = (joint_.least - q_) / step_s;
  most_rate_ = (joint_.most - q_) / step_s;
}

void BodyJoint::move(double rate, double step_s) noexcept {
  if (untouched_) {
    q_ = next_q_;
    return;
  }
  rate_ = rate;
  q_ = std::clamp(q_ + step_s * rate_, joint_.least, joint_.most);
}

double BodyJoint::energy() const noexcept {
  return 0.5 * inertia_ * rate_ * rate_ + storedEnergy(joint_, q_);
}

}  // namespace wholehand
