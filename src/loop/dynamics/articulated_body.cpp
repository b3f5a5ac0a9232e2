#include "loop/dynamics/articulated_body.hpp"

#include "loop/core/compiler.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace wholehand {

namespace {

using Factor = std::array<std::array<double, kMaxAxes>, kMaxAxes>;

/// Cholesky factor L with matrix = L Lᵀ; its diagonal holds 1 / L(j, j).
bool factor(const AxisMatrix& matrix, Factor& l) noexcept {
  const int n = static_cast<int>(matrix.rows());
  for (int j = 0; j < n; ++j) {
    double pivot = matrix(j, j);
    for (int k = 0; k < j; ++k) pivot -= l[j][k] * l[j][k];
    if (!(pivot > 0.0) || !std::isfinite(pivot)) return false;
    l[j][j] = 1.0 / std::sqrt(pivot);
    for (int i = j + 1; i < n; ++i) {
      double sum = matrix(i, j);
      for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = sum * l[j][j];
    }
  }
  return true;
}

/// Replaces L by L⁻¹, lower triangular.
void invertFactor(Factor& l, int n) noexcept {
  for (int c = 0; c < n; ++c) {
    for (int i = c + 1; i < n; ++i) {
      double sum = 0.0;
      for (int k = c; k < i; ++k) sum += l[i][k] * l[k][c];
      l[i][c] = -sum * l[i][i];
    }
  }
}

}  // namespace

bool invertPositiveDefinite(const AxisMatrix& matrix, AxisMatrix& inverse) noexcept {
  const int n = static_cast<int>(matrix.rows());
  inverse.resize(n, n);
  Factor l;  // only the lower triangle is written and read
  if (!factor(matrix, l)) {
    inverse.setZero();
    return false;
  }
  invertFactor(l, n);
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) {
      double sum = 0.0;
      for (int k = i; k < n; ++k) sum += l[k][i] * l[k][j];
      inverse(i, j) = sum;
      inverse(j, i) = sum;
    }
  }
  return true;
}

namespace {

/// Rotation by `angle_rad` about the unit vector `axis` (Rodrigues).
Eigen::Matrix3d rotationAbout(const Eigen::Vector3d& axis, double angle_rad) noexcept {
  double s = 0.0, c = 0.0;
  ::sincos(angle_rad, &s, &c);
  const Eigen::Vector3d a = (1.0 - c) * axis;
  const double x = axis.x(), y = axis.y(), z = axis.z();
  Eigen::Matrix3d r;
  r << c + a.x() * x, a.x() * y - s * z, a.x() * z + s * y,  //
      a.y() * x + s * z, c + a.y() * y, a.y() * z - s * x,   //
      a.z() * x - s * y, a.z() * y + s * x, c + a.z() * z;
  return r;
}

/// Computes turn * rotationAbout(axis, angle_rad) for a coordinate axis, as most joints of a hand
/// have. Bit-identical to the general product, whose other terms are zero.
void turnAbout(int along, double way, double angle_rad, Eigen::Matrix3d& turn) noexcept {
  double s = 0.0, c = 0.0;
  ::sincos(angle_rad, &s, &c);
  s *= way;
  const int i = (along + 1) % 3, j = (along + 2) % 3;
  const double rest = c + (1.0 - c) * way * way;
  for (int r = 0; r < 3; ++r) {
    const double a = turn(r, i), b = turn(r, j);
    turn(r, i) = a * c + b * s;
    turn(r, j) = b * c - a * s;
    turn(r, along) *= rest;
  }
}

/// Product by components: at -O2 Eigen's own calls functions.
Eigen::Vector3d product(const Eigen::Matrix3d& a, const Eigen::Vector3d& v) noexcept {
  const auto row = [&](int r) { return a(r, 0) * v[0] + a(r, 1) * v[1] + a(r, 2) * v[2]; };
  return {row(0), row(1), row(2)};
}

/// Inertia of a unit point mass at `r_m` about the origin.
Eigen::Matrix3d steiner(const Eigen::Vector3d& r_m) {
  return r_m.squaredNorm() * Eigen::Matrix3d::Identity() - r_m * r_m.transpose();
}

}  // namespace

ArticulatedBody::ArticulatedBody(const HandModel& hand, const AxisInertia& armature)
    : hand_(&hand), armature_(armature) {
  assert(hand.links.size() <= kMaxLinks && hand.joint_count <= kMaxJoints);
  std::array<Pose, kMaxLinks> in_body;  // every link in the frame of the body that carries it
  for (int i = 0; i < static_cast<int>(hand.links.size()); ++i) {
    const HandLink& link = hand.links[i];
    const int parent = link.parent < 0 ? -1 : body_of_link_[link.parent];
    const Pose place =
        link.parent < 0 ? link.parent_to_link : in_body[link.parent] * link.parent_to_link;
    if (link.type == JointType::kFixed || link.joint < 0) {
      body_of_link_[i] = parent;
      in_body[i] = place;
      weld_[weld_count_++] = {i, parent, place};
      if (parent >= 0) addMass(body_[parent], link, place);
    } else {
      addBody(i, parent, place);
    }
  }
  const int n = hand.joint_count;
  bias_ = JointEffort(n);
  inertia_ = JointMatrix::Zero(n, n);
  inertia_synergy_ = JointAxisMatrix::Zero(n, hand.axis_count);
  reduced_bias_ = AxisEffort(hand.axis_count);
  reduced_inertia_ = AxisMatrix::Zero(hand.axis_count, hand.axis_count);
  reduced_inertia_inverse_ = reduced_inertia_;
}

void ArticulatedBody::addBody(int link, int parent, const Pose& parent_to_body) {
  const HandLink& l = hand_->links[link];
  Body b;
  b.parent = parent;
  b.link = link;
  b.joint = l.joint;
  b.revolute = l.type == JointType::kRevolute;
  b.axis = l.axis;
  for (int k = 0; k < 3; ++k) {
    if (std::abs(l.axis[k]) == 1.0) b.along = k;
  }
  b.parent_to_body = parent_to_body;
  b.turned = parent_to_body.rotation != Eigen::Matrix3d::Identity();
  addMass(b, l, Pose{});
  b.first_term = term_count_;
  for (int a = 0; a < hand_->axis_count; ++a) {
    const double ratio = hand_->synergy(l.joint, a);
    if (ratio != 0.0) terms_[term_count_++] = {a, ratio};
  }
  b.end_term = term_count_;
  body_of_link_[link] = body_count_;
  body_[body_count_++] = b;
}

void ArticulatedBody::addMass(Body& body, const HandLink& link, const Pose& body_to_link) {
  if (link.mass_kg <= 0.0) return;
  const Eigen::Vector3d com_m = body_to_link * link.com_m;
  const double mass_kg = body.mass_kg + link.mass_kg;
  const Eigen::Vector3d joint_com_m = (body.mass_kg * body.com_m + link.mass_kg * com_m) / mass_kg;
  body.inertia_kg_m2 += body.mass_kg * steiner(body.com_m - joint_com_m);
  body.inertia_kg_m2 +=
      body_to_link.rotation * link.inertia_kg_m2 * body_to_link.rotation.transpose() +
      link.mass_kg * steiner(com_m - joint_com_m);
  body.mass_kg = mass_kg;
  body.com_m = joint_com_m;
}

void ArticulatedBody::placeBody(int i, double position) noexcept {
  const Body& b = body_[i];
  Pose& pose = pose_[b.link];
  if (b.parent < 0) {
    pose = b.parent_to_body;
  } else {
    const Pose& parent = pose_[body_[b.parent].link];
    pose.rotation = parent.rotation;
    if (b.turned) pose.rotation = parent.rotation * b.parent_to_body.rotation;
    pose.translation_m =
        product(parent.rotation, b.parent_to_body.translation_m) + parent.translation_m;
  }
  if (!b.revolute) {
    const Eigen::Vector3d axis = product(pose.rotation, b.axis);
    pose.translation_m += position * axis;
    screw_[i] = {Eigen::Vector3d::Zero(), axis};
    return;
  }
  if (b.along >= 0) {
    turnAbout(b.along, b.axis[b.along], position, pose.rotation);
  } else {
    pose.rotation = (pose.rotation * rotationAbout(b.axis, position)).eval();
  }
  const Eigen::Vector3d axis = product(pose.rotation, b.axis);
  screw_[i] = {axis, cross(pose.translation_m, axis)};
}

[[gnu::flatten]] WHOLEHAND_VECTOR_CLONES void ArticulatedBody::placeLinks(
    const JointPosition& theta) noexcept {
  for (int i = 0; i < body_count_; ++i) placeBody(i, theta[body_[i].joint]);
  for (int i = 0; i < weld_count_; ++i) {
    const Weld& w = weld_[i];
    pose_[w.link] = w.body < 0 ? w.body_to_link : pose_[body_[w.body].link] * w.body_to_link;
  }
}

void ArticulatedBody::updateKinematics(const JointPosition& theta) noexcept {
  placeLinks(theta);
}

// Outward Newton-Euler recursion: computes velocities, accelerations at θ̈ = 0, and the wrench on
// each body. Gravity is modelled as an upward acceleration of the world.
void ArticulatedBody::sweepForward(const JointVelocity& theta_dot,
                                   const Eigen::Vector3d& gravity_m_s2) noexcept {
  const SpatialVector world_velocity;
  const SpatialVector world_acceleration{Eigen::Vector3d::Zero(), -gravity_m_s2};
  for (int i = 0; i < body_count_; ++i) {
    const Body& b = body_[i];
    const double rate = theta_dot[b.joint];
    const SpatialVector own{rate * screw_[i].angular, rate * screw_[i].linear};
    SpatialVector& v = velocity_[i];
    SpatialVector& a = acceleration_[i];
    v = b.parent < 0 ? world_velocity : velocity_[b.parent];
    a = b.parent < 0 ? world_acceleration : acceleration_[b.parent];
    v += own;
    a += crossMotion(v, own);
    composite_[i] = inertiaInWorld(b.mass_kg, b.com_m, b.inertia_kg_m2, pose_[b.link]);
    force_[i] = composite_[i] * a;
    force_[i] += crossForce(v, composite_[i] * v);
  }
}

// Inward recursion: h sums the wrenches, M the composite inertias. M is zero by structure except
// between a joint and its ancestors.
void ArticulatedBody::sweepBackward() noexcept {
  for (int i = body_count_ - 1; i >= 0; --i) {
    const Body& b = body_[i];
    bias_[b.joint] = dot(screw_[i], force_[i]);
    if (b.parent >= 0) {
      force_[b.parent] += force_[i];
      composite_[b.parent] += composite_[i];
    }
    const SpatialVector momentum = composite_[i] * screw_[i];
    for (int j = i; j >= 0; j = body_[j].parent) {
      const double m = dot(screw_[j], momentum);
      inertia_(b.joint, body_[j].joint) = m;
      inertia_(body_[j].joint, b.joint) = m;
    }
  }
}

void ArticulatedBody::reduce() noexcept {
  inertia_synergy_.setZero();
  reduced_inertia_.setZero();
  reduced_bias_.vec().setZero();
  for (int i = 0; i < body_count_; ++i) {
    const Body& b = body_[i];
    for (int t = b.first_term; t < b.end_term; ++t) {
      const Term& term = terms_[t];
      inertia_synergy_.col(term.axis) += term.ratio * inertia_.col(b.joint);
      reduced_bias_[term.axis] += term.ratio * bias_[b.joint];
    }
  }
  for (int i = 0; i < body_count_; ++i) {
    const Body& b = body_[i];
    for (int t = b.first_term; t < b.end_term; ++t) {
      const Term& term = terms_[t];
      for (int a = 0; a <= term.axis; ++a) {
        reduced_inertia_(term.axis, a) += term.ratio * inertia_synergy_(b.joint, a);
      }
    }
  }
  // Only the lower triangle was summed. Copying it to the upper one makes M_r exactly symmetric.
  for (int a = 0; a < hand_->axis_count; ++a) {
    for (int c = 0; c < a; ++c) reduced_inertia_(c, a) = reduced_inertia_(a, c);
  }
  for (int a = 0; a < armature_.size(); ++a) reduced_inertia_(a, a) += armature_[a];
}

[[gnu::flatten]] WHOLEHAND_VECTOR_CLONES bool ArticulatedBody::updateDynamics(
    const JointVelocity& theta_dot, const Eigen::Vector3d& gravity_m_s2) noexcept {
  sweepForward(theta_dot, gravity_m_s2);
  sweepBackward();
  reduce();
  return invertPositiveDefinite(reduced_inertia_, reduced_inertia_inverse_);
}

bool ArticulatedBody::update(const JointPosition& theta, const JointVelocity& theta_dot,
                             const Eigen::Vector3d& gravity_m_s2) noexcept {
  updateKinematics(theta);
  return updateDynamics(theta_dot, gravity_m_s2);
}

bool ArticulatedBody::updateFrom(const ArticulatedBody& placed, const JointVelocity& theta_dot,
                                 const Eigen::Vector3d& gravity_m_s2) noexcept {
  assert(placed.body_count_ == body_count_ && placed.hand_->links.size() == hand_->links.size());
  std::copy_n(placed.pose_.begin(), hand_->links.size(), pose_.begin());
  std::copy_n(placed.screw_.begin(), body_count_, screw_.begin());
  return updateDynamics(theta_dot, gravity_m_s2);
}

void ArticulatedBody::distribute(const AxisEffort& f_s, JointEffort& torque) const noexcept {
  torque = bias_;
  for (int a = 0; a < hand_->axis_count; ++a) {
    double acceleration = 0.0;
    for (int c = 0; c < hand_->axis_count; ++c) {
      acceleration += reduced_inertia_inverse_(c, a) * f_s[c];  // symmetric: reads down a column
    }
    for (int j = 0; j < hand_->joint_count; ++j) {
      torque[j] += inertia_synergy_(j, a) * acceleration;
    }
  }
}

AxisEffort ArticulatedBody::armatureEffort(const AxisEffort& f_s) const noexcept {
  AxisEffort out(hand_->axis_count);
  for (int a = 0; a < armature_.size(); ++a) {
    for (int c = 0; c < hand_->axis_count; ++c) {
      out[a] += armature_[a] * reduced_inertia_inverse_(c, a) * f_s[c];
    }
  }
  return out;
}

void ArticulatedBody::reducedPointRow(int link, const Eigen::Vector3d& point_m,
                                      const Eigen::Vector3d& direction,
                                      double* row) const noexcept {
  for (int a = 0; a < hand_->axis_count; ++a) row[a] = 0.0;
  const SpatialVector wrench{cross(point_m, direction), direction};
  for (int i = body_of_link_[link]; i >= 0; i = body_[i].parent) {
    const double rate = dot(screw_[i], wrench);
    for (int t = body_[i].first_term; t < body_[i].end_term; ++t) {
      row[terms_[t].axis] += terms_[t].ratio * rate;
    }
  }
}

void ArticulatedBody::reducedAngularRow(int link, const Eigen::Vector3d& direction,
                                        double* row) const noexcept {
  for (int a = 0; a < hand_->axis_count; ++a) row[a] = 0.0;
  for (int i = body_of_link_[link]; i >= 0; i = body_[i].parent) {
    const double rate = screw_[i].angular.dot(direction);
    for (int t = body_[i].first_term; t < body_[i].end_term; ++t) {
      row[terms_[t].axis] += terms_[t].ratio * rate;
    }
  }
}

namespace {

/// Four numbers, of one row each. Sums are written out in the order of Eigen's dot products.
using FourRows = double __attribute__((vector_size(32)));

// The result is a reference, because returning a vector would need AVX in the caller.
[[gnu::always_inline]] inline void dotRows(FourRows& to, const Eigen::Vector3d& a,
                                           const std::array<FourRows, 3>& b) noexcept {
  to = (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

}  // namespace

[[gnu::flatten]] WHOLEHAND_VECTOR_CLONES void ArticulatedBody::sumContactRows(
    int link, const Eigen::Vector3d& point_m, const std::array<Eigen::Vector3d, 3>& directions,
    const std::array<double*, 4>& rows) const noexcept {
  std::array<Eigen::Vector3d, 3> moments;
  for (int k = 0; k < 3; ++k) moments[k] = cross(point_m, directions[k]);
  std::array<FourRows, 3> moment, force;
  for (int c = 0; c < 3; ++c) {
    moment[c] = FourRows{moments[0][c], moments[1][c], moments[2][c], directions[0][c]};
    force[c] = FourRows{directions[0][c], directions[1][c], directions[2][c], 0.0};
  }
  std::array<FourRows, kMaxAxes> sums;
  for (int a = 0; a < hand_->axis_count; ++a) sums[a] = FourRows{};
  for (int i = body_of_link_[link]; i >= 0; i = body_[i].parent) {
    FourRows turning, sliding;
    dotRows(turning, screw_[i].angular, moment);
    dotRows(sliding, screw_[i].linear, force);
    const FourRows rate = turning + sliding;
    for (int t = body_[i].first_term; t < body_[i].end_term; ++t) {
      sums[terms_[t].axis] += terms_[t].ratio * rate;
    }
  }
  for (int a = 0; a < hand_->axis_count; ++a) {
    for (int k = 0; k < 4; ++k) rows[k][a] = sums[a][k];
  }
}

void ArticulatedBody::reducedContactRows(int link, const Eigen::Vector3d& point_m,
                                         const std::array<Eigen::Vector3d, 3>& directions,
                                         const std::array<double*, 4>& rows) const noexcept {
  sumContactRows(link, point_m, directions, rows);
}

}  // namespace wholehand
