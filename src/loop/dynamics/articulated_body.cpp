#include "loop/dynamics/articulated_body.hpp"

#include "loop/core/compiler.hpp"
#include "loop/core/four_numbers.hpp"

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
  for (int i = 0; i < (body_count_ + 3) / 4 * 4; ++i) {
    const Body& b = body_[std::min(i, body_count_ - 1)];
    FourBodies& to = four_bodies_[i / 4];
    to.mass_kg[i % 4] = b.mass_kg;
    for (int k = 0; k < 3; ++k) to.com_m[k][i % 4] = b.com_m[k];
    for (int k = 0; k < 9; ++k) to.inertia_kg_m2[k][i % 4] = b.inertia_kg_m2(k % 3, k / 3);
  }
  const int n = hand.joint_count;
  bias_ = JointEffort(n);
  inertia_ = JointMatrix::Zero(n, n);
  inertia_synergy_height_ = (n + 3) / 4 * 4;
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

namespace {

static_assert(sizeof(Pose) == 12 * sizeof(double) && sizeof(SpatialInertia) == 10 * sizeof(double));

/// Collects Count numbers of each of four objects that hold them one after the other.
template <std::size_t Count, class From>
[[gnu::always_inline]] inline void gather(std::array<FourNumbers, Count>& to,
                                          const std::array<const From*, 4>& from) noexcept {
  static_assert(sizeof(From) == Count * sizeof(double) && Count % 4 == 0);
  std::array<const double*, 4> numbers;
  for (int lane = 0; lane < 4; ++lane) numbers[lane] = reinterpret_cast<const double*>(from[lane]);
  for (std::size_t k = 0; k < Count; k += 4) {
    for (std::size_t lane = 0; lane < 4; ++lane) load(to[k + lane], numbers[lane] + k);
    transpose(to[k], to[k + 1], to[k + 2], to[k + 3]);
  }
}

/// Four spatial vectors.
struct FourSpatials {
  FourVectors angular, linear;
};

/// Four of SpatialInertia.
struct FourInertias {
  FourNumbers mass_kg;
  FourVectors first_moment;
  FourNumbers xx, yy, zz, xy, xz, yz;

  /// SpatialInertia::operator*.
  [[gnu::always_inline]] inline void multiply(FourSpatials& to, const FourSpatials& v) const {
    const FourVectors& w = v.angular;
    FourVectors moves, turns;
    cross(moves, first_moment, v.linear);
    cross(turns, first_moment, w);
    to.angular = {(xx * w.x + xy * w.y + xz * w.z) + moves.x,
                  (xy * w.x + yy * w.y + yz * w.z) + moves.y,
                  (xz * w.x + yz * w.y + zz * w.z) + moves.z};
    to.linear = {mass_kg * v.linear.x - turns.x, mass_kg * v.linear.y - turns.y,
                 mass_kg * v.linear.z - turns.z};
  }
};

[[gnu::always_inline]] inline void add(FourVectors& to, const FourVectors& more) noexcept {
  to.x += more.x, to.y += more.y, to.z += more.z;
}

/// to += factor · more, for a count that is a multiple of four
[[gnu::always_inline]] inline void addScaled(double* to, double factor, const double* more,
                                             int count) noexcept {
  for (int k = 0; k < count; k += 4) {
    FourNumbers a, b;
    load(a, to + k), load(b, more + k);
    store(a + factor * b, to + k);
  }
}

/// Adds the numbers of an object to those of another.
template <class Of>
[[gnu::always_inline]] inline void addNumbers(Of& to, const Of& more) noexcept {
  static_assert(sizeof(Of) % sizeof(FourNumbers) == 0);
  auto* sums = reinterpret_cast<double*>(&to);
  const auto* numbers = reinterpret_cast<const double*>(&more);
  for (std::size_t k = 0; k < sizeof(Of) / sizeof(double); k += 4) {
    FourNumbers a, b;
    load(a, sums + k), load(b, numbers + k);
    store(a + b, sums + k);
  }
}

}  // namespace

// Computes the inertia in world axes and the wrench of four bodies at once, because this is most of
// the work. Each sum has the order of inertiaInWorld() and of SpatialInertia.
[[gnu::always_inline]] inline void ArticulatedBody::weighFour(int first) noexcept {
  std::array<int, 4> at;
  std::array<const Pose*, 4> poses;
  std::array<const Motion*, 4> motions;
  for (int lane = 0; lane < 4; ++lane) {
    at[lane] = std::min(first + lane, body_count_ - 1);
    poses[lane] = &pose_[body_[at[lane]].link];
    motions[lane] = &motion_[at[lane]];
  }
  std::array<FourNumbers, 12> pose, moves;
  gather(pose, poses);
  gather(moves, motions);
  const FourBodies& of = four_bodies_[first / 4];
  // The rotation by rows, and the centre of mass.
  const std::array<FourVectors, 3> r{FourVectors{pose[0], pose[3], pose[6]},
                                     {pose[1], pose[4], pose[7]},
                                     {pose[2], pose[5], pose[8]}};
  FourVectors com, c;
  load(com.x, of.com_m[0].data()), load(com.y, of.com_m[1].data()), load(com.z, of.com_m[2].data());
  dot(c.x, r[0], com), dot(c.y, r[1], com), dot(c.z, r[2], com);
  c.x += pose[9], c.y += pose[10], c.z += pose[11];
  // R I by rows, then R I Rᵀ.
  std::array<FourVectors, 3> ri;
  for (int k = 0; k < 3; ++k) {
    FourVectors column;
    load(column.x, of.inertia_kg_m2[3 * k].data());
    load(column.y, of.inertia_kg_m2[3 * k + 1].data());
    load(column.z, of.inertia_kg_m2[3 * k + 2].data());
    for (int row = 0; row < 3; ++row) {
      FourNumbers& to = k == 0 ? ri[row].x : k == 1 ? ri[row].y : ri[row].z;
      dot(to, r[row], column);
    }
  }
  FourInertias inertia;
  FourNumbers& m = inertia.mass_kg;
  load(m, of.mass_kg.data());
  inertia.first_moment = {m * c.x, m * c.y, m * c.z};
  dot(inertia.xx, ri[0], r[0]), dot(inertia.yy, ri[1], r[1]), dot(inertia.zz, ri[2], r[2]);
  dot(inertia.xy, ri[0], r[1]), dot(inertia.xz, ri[0], r[2]), dot(inertia.yz, ri[1], r[2]);
  inertia.xx += m * (c.y * c.y + c.z * c.z);
  inertia.yy += m * (c.x * c.x + c.z * c.z);
  inertia.zz += m * (c.x * c.x + c.y * c.y);
  inertia.xy -= m * c.x * c.y;
  inertia.xz -= m * c.x * c.z;
  inertia.yz -= m * c.y * c.z;
  // The wrench I a + v × (I v).
  const FourSpatials v{{moves[0], moves[1], moves[2]}, {moves[3], moves[4], moves[5]}};
  const FourSpatials a{{moves[6], moves[7], moves[8]}, {moves[9], moves[10], moves[11]}};
  FourSpatials wrench, momentum;
  inertia.multiply(wrench, a);
  inertia.multiply(momentum, v);
  FourVectors turned, pulled, moved;
  cross(turned, v.angular, momentum.angular);
  cross(pulled, v.linear, momentum.linear);
  cross(moved, v.angular, momentum.linear);
  add(turned, pulled);
  add(wrench.angular, turned);
  add(wrench.linear, moved);
  // Writes them as Load has them.
  std::array<FourNumbers, 16> load_of{m,
                                      inertia.first_moment.x,
                                      inertia.first_moment.y,
                                      inertia.first_moment.z,
                                      inertia.xx,
                                      inertia.yy,
                                      inertia.zz,
                                      inertia.xy,
                                      inertia.xz,
                                      inertia.yz,
                                      wrench.angular.x,
                                      wrench.angular.y,
                                      wrench.angular.z,
                                      wrench.linear.x,
                                      wrench.linear.y,
                                      wrench.linear.z};
  for (int k = 0; k < 16; k += 4) {
    transpose(load_of[k], load_of[k + 1], load_of[k + 2], load_of[k + 3]);
    for (int lane = 0; lane < 4; ++lane) {
      store(load_of[k + lane], reinterpret_cast<double*>(&load_[at[lane]]) + k);
    }
  }
}

// Outward Newton-Euler recursion: computes velocities, accelerations at θ̈ = 0, and the wrench on
// each body. Gravity is modelled as an upward acceleration of the world.
void ArticulatedBody::sweepForward(const JointVelocity& theta_dot,
                                   const Eigen::Vector3d& gravity_m_s2) noexcept {
  const Motion world{{}, {Eigen::Vector3d::Zero(), -gravity_m_s2}};
  for (int i = 0; i < body_count_; ++i) {
    const Body& b = body_[i];
    const double rate = theta_dot[b.joint];
    const SpatialVector own{rate * screw_[i].angular, rate * screw_[i].linear};
    Motion& motion = motion_[i];
    motion = b.parent < 0 ? world : motion_[b.parent];
    motion.velocity += own;
    motion.acceleration += crossMotion(motion.velocity, own);
  }
  for (int i = 0; i < body_count_; i += 4) weighFour(i);
}

// Inward recursion: h sums the wrenches, M the composite inertias. M is zero by structure except
// between a joint and its ancestors.
void ArticulatedBody::sweepBackward() noexcept {
  const std::ptrdiff_t joints = hand_->joint_count;
  for (int i = body_count_ - 1; i >= 0; --i) {
    const Body& b = body_[i];
    bias_[b.joint] = dot(screw_[i], load_[i].wrench);
    if (b.parent >= 0) addNumbers(load_[b.parent], load_[i]);
    const SpatialVector momentum = load_[i].inertia * screw_[i];
    double* column = inertia_.data() + joints * b.joint;
    for (int j = i; j >= 0; j = body_[j].parent) {
      const std::ptrdiff_t row = body_[j].joint;
      const double m = dot(screw_[j], momentum);
      column[row] = m;
      inertia_.data()[joints * row + b.joint] = m;
    }
  }
}

// Sums four joints or axes at once: M G by its columns, then M_r by its rows. What lies between the
// last joint or axis and the next multiple of four is not used.
void ArticulatedBody::reduce() noexcept {
  const std::ptrdiff_t joints = hand_->joint_count;
  const int axes = hand_->axis_count;
  const int tall = inertia_synergy_height_, wide = (axes + 3) / 4 * 4;
  std::fill_n(inertia_synergy_.begin(), wide * tall, 0.0);
  reduced_bias_.vec().setZero();
  for (int i = 0; i < body_count_; ++i) {
    const Body& b = body_[i];
    const double* inertia = inertia_.data() + joints * b.joint;
    for (int t = b.first_term; t < b.end_term; ++t) {
      const Term& term = terms_[t];
      addScaled(&inertia_synergy_[term.axis * tall], term.ratio, inertia, tall);
      reduced_bias_[term.axis] += term.ratio * bias_[b.joint];
    }
  }
  alignas(32) std::array<double, kMaxJoints * kMaxAxes> rows;
  for (int a = 0; a < wide; a += 4) {
    const double* column = &inertia_synergy_[a * tall];
    for (int j = 0; j < tall; j += 4, column += 4) {
      FourNumbers c0, c1, c2, c3;
      load(c0, column), load(c1, column + tall);
      load(c2, column + 2 * tall), load(c3, column + 3 * tall);
      transpose(c0, c1, c2, c3);
      double* row = &rows[j * wide + a];
      store(c0, row), store(c1, row + wide), store(c2, row + 2 * wide), store(c3, row + 3 * wide);
    }
  }
  alignas(32) std::array<double, kMaxAxes * kMaxAxes> reduced;
  std::fill_n(reduced.begin(), wide * wide, 0.0);
  for (int i = 0; i < body_count_; ++i) {
    const Body& b = body_[i];
    for (int t = b.first_term; t < b.end_term; ++t) {
      addScaled(&reduced[terms_[t].axis * wide], terms_[t].ratio, &rows[b.joint * wide], wide);
    }
  }
  // Only the lower triangle is taken. Copying it to the upper one makes M_r exactly symmetric.
  for (int a = 0; a < axes; ++a) {
    for (int c = 0; c <= a; ++c) {
      reduced_inertia_(a, c) = reduced[a * wide + c];
      reduced_inertia_(c, a) = reduced[a * wide + c];
    }
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
    const double* column = &inertia_synergy_[a * inertia_synergy_height_];
    for (int j = 0; j < hand_->joint_count; ++j) torque[j] += column[j] * acceleration;
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

/// Four numbers, of one row each; the sum has the order of Eigen's dot products.
[[gnu::always_inline]] inline void dotRows(FourNumbers& to, const Eigen::Vector3d& a,
                                           const std::array<FourNumbers, 3>& b) noexcept {
  to = (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
}

}  // namespace

[[gnu::flatten]] WHOLEHAND_VECTOR_CLONES void ArticulatedBody::sumContactRows(
    int link, const Eigen::Vector3d& point_m, const std::array<Eigen::Vector3d, 3>& directions,
    const std::array<double*, 4>& rows) const noexcept {
  std::array<Eigen::Vector3d, 3> moments;
  for (int k = 0; k < 3; ++k) moments[k] = cross(point_m, directions[k]);
  std::array<FourNumbers, 3> moment, force;
  for (int c = 0; c < 3; ++c) {
    moment[c] = FourNumbers{moments[0][c], moments[1][c], moments[2][c], directions[0][c]};
    force[c] = FourNumbers{directions[0][c], directions[1][c], directions[2][c], 0.0};
  }
  std::array<FourNumbers, kMaxAxes> sums;
  for (int a = 0; a < hand_->axis_count; ++a) sums[a] = FourNumbers{};
  for (int i = body_of_link_[link]; i >= 0; i = body_[i].parent) {
    FourNumbers turning, sliding;
    dotRows(turning, screw_[i].angular, moment);
    dotRows(sliding, screw_[i].linear, force);
    const FourNumbers rate = turning + sliding;
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
