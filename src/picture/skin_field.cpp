#include "picture/skin_field.hpp"

#include "picture/smooth.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kGroups = 6;       // parts of a hand
constexpr double kLightStep_m = 0.0022;  // calms the palm, follows a finger
constexpr double kCrease_m = 0.0005;     // half width of a flexion line
constexpr double kThin_m = 1e-6;         // keeps a blend's width positive
constexpr double kFar = 1e9;

}  // namespace

double SkinField::capsule(const Placed& c, const Vector3d& p) const noexcept {
  const Vector3d ap = p - c.a;
  const double t = std::clamp(ap.dot(c.ab) * c.inverse_length2, 0.0, 1.0);
  return (ap - t * c.ab).norm() - c.radius;
}

double SkinField::colliders(const Vector3d& p_m) const noexcept {
  double d = kFar;
  for (const Placed& c : capsules_) d = std::min(d, capsule(c, p_m));
  return d;
}

const SkinField::Block* SkinField::block(const Vector3d& p) const noexcept {
  const Eigen::Array3d at = (p - origin_m_).array() / (kNode_m * kBlockNodes);
  if ((at < 0.0).any() || (at >= blocks_.cast<double>()).any()) return nullptr;
  const Eigen::Array<std::size_t, 3, 1> i = at.cast<std::size_t>();
  const auto wide = static_cast<std::size_t>(blocks_.x()),
             deep = static_cast<std::size_t>(blocks_.y());
  return &block_[(i.z() * deep + i.y()) * wide + i.x()];
}

double SkinField::blend(const Placed& c, const Vector3d& p, double within_digit,
                        double with_palm) const noexcept {
  const double k = c.part == HandPart::kPalm    ? with_palm
                   : c.part == HandPart::kThumb ? with_palm * recipe_.thumb_share
                                                : within_digit;
  if (!c.joined) return k;
  // At a joint a blend would swell a straight finger: it is wanted in the inside of the bend only.
  return k * std::clamp(c.bend.dot(p - c.a) / c.radius, 0.0, 1.0) + kThin_m;
}

double SkinField::blended(const List& list, const Vector3d& p, double within_digit,
                          double with_palm, double& hard) const noexcept {
  std::array<double, kGroups> united;
  united.fill(kFar);
  hard = kFar;
  for (std::uint32_t i = list.first; i < list.first + list.count; ++i) {
    const Placed& c = capsules_[candidates_[i]];
    const Vector3d ap = p - c.a;
    const double t = std::clamp(ap.dot(c.ab) * c.inverse_length2, 0.0, 1.0);
    const double to_axis = (ap - t * c.ab).norm();
    hard = std::min(hard, to_axis - c.radius);
    const double d = to_axis - c.skin_radius_a - t * (c.skin_radius_b - c.skin_radius_a);
    double& u = united[static_cast<std::size_t>(c.part)];
    u = smoothMin(u, d, blend(c, p, within_digit, with_palm));
  }
  double d = united[0];
  for (std::size_t g = 1; g < united.size(); ++g) {
    d = std::min(d, smoothMin(united[0], united[g], with_palm));
  }
  return d;
}

double SkinField::skin(const Vector3d& p_m) const noexcept {
  const Block* b = block(p_m);
  if (b == nullptr) return colliders(p_m) - recipe_.leave_m;
  // Sampled with 4 mm the interpolated distance of a finger is at most 1 mm too large.
  if (b->drawn.count == 0) return roughly(p_m) - 0.0015;
  double hard = kFar;
  const double united = blended(b->drawn, p_m, recipe_.blend_m, recipe_.blend_m, hard);
  if (united > kNear_m) return std::min(united, hard - recipe_.leave_m);
  const double nailed = united - recipe_.nail_m * nailShare(p_m);
  const double filled = smoothMin(nailed, hard + recipe_.leave_m, recipe_.clamp_m);
  return smoothMax(filled, hard - recipe_.leave_m, recipe_.clamp_m);
}

double SkinField::estimate(const Vector3d& p_m) const noexcept {
  const Block* b = block(p_m);
  return b == nullptr || b->drawn.count == 0 ? roughly(p_m) : skin(p_m);
}

double SkinField::roughly(const Vector3d& p_m) const noexcept {
  const Eigen::Array3d at = (p_m - origin_m_).array() / kNode_m;
  if ((at < 0.0).any() || (at >= (nodes_ - 1).cast<double>()).any()) {
    return colliders(p_m);
  }
  const Eigen::Array3i i = at.cast<int>();
  const Eigen::Array3d f = at - i.cast<double>();
  const auto row = static_cast<std::size_t>(nodes_.x());
  const std::size_t slab = row * static_cast<std::size_t>(nodes_.y());
  const float* s =
      &sampled_m_[static_cast<std::size_t>(i.z()) * slab + static_cast<std::size_t>(i.y()) * row +
                  static_cast<std::size_t>(i.x())];
  const auto along = [&](const float* q) {
    return static_cast<double>(q[0]) + f.x() * static_cast<double>(q[1] - q[0]);
  };
  const auto across = [&](const float* q) {
    return along(q) + f.y() * (along(q + row) - along(q));
  };
  return across(s) + f.z() * (across(s + slab) - across(s));
}

double SkinField::soft(const Vector3d& p) const noexcept {
  const Block* b = block(p);
  if (b == nullptr || b->drawn.count == 0) return roughly(p);
  double hard = kFar;
  return blended(b->lit, p, recipe_.digit_light_m, recipe_.palm_light_m, hard);
}

Vector3d SkinField::lightNormal(const Vector3d& p_m) const noexcept {
  const auto gradient = [&](double h, auto&& field) {
    Vector3d g;
    for (int i = 0; i < 3; ++i) {
      const Vector3d e = h * Vector3d::Unit(i);
      g[i] = field(p_m + e) - field(p_m - e);
    }
    return Vector3d(g.normalized());
  };
  if (nailShare(p_m) > 0.0) {
    return gradient(0.0003, [this](const Vector3d& q) { return skin(q); });
  }
  return gradient(kLightStep_m, [this](const Vector3d& q) { return soft(q); });
}

double SkinField::nailShare(const Vector3d& p) const noexcept {
  for (const Nail& n : nails_) {
    if ((p - n.center).squaredNorm() > 4.0 * n.radius * n.radius) continue;
    const Vector3d q = p - n.root;
    const double s = q.dot(n.along);
    const double up = q.dot(n.dorsal);
    if (up <= 0.0) continue;
    // A rounded square, wrapped around the last capsule: a superellipse in arc and length.
    const double length = 1.55 * n.radius;
    const double end = n.segment + 0.66 * n.radius;
    const double u = std::atan2(q.dot(n.side), up) / 0.80;
    const double v = 2.0 * (s - end) / length + 1.0;
    const double edge = std::pow(std::pow(std::abs(u), 3.2) + std::pow(std::abs(v), 3.2), 1 / 3.2);
    return smoothStep(1.05, 0.95, edge);
  }
  return 0.0;
}

SkinLook SkinField::look(const Vector3d& p_m, const Vector3d& normal) const noexcept {
  SkinLook look;
  const Block* b = block(p_m);
  if (b == nullptr || b->drawn.count == 0) return look;
  double hard = kFar;
  const double united = blended(b->lit, p_m, recipe_.digit_light_m, recipe_.palm_light_m, hard);
  look.fold = std::clamp(-united / 0.0032, 0.0, 1.0);
  look.nail = nailShare(p_m);
  // Capsules near the point share it by distance, so that no colour has a seam.
  double weight = 0.0;
  Vector3d palmar = Vector3d::Zero();
  for (std::uint32_t i = b->drawn.first; i < b->drawn.first + b->drawn.count; ++i) {
    const Placed& c = capsules_[candidates_[i]];
    const double w = std::exp(-(capsule(c, p_m) - hard) / 0.0025);
    const double s = (p_m - c.a).dot(c.ab) * c.inverse_length2 * c.length;
    weight += w;
    palmar += w * c.palmar;
    if (c.part == HandPart::kPalm) continue;
    const double pulp = normal.dot(c.palmar);
    const double knuckle = std::exp(-std::pow(s / 0.007, 2.0)) * (0.5 - 0.5 * pulp);
    const double tip = c.tip ? smoothStep(0.2 * c.length, 1.3 * c.length, s) : 0.0;
    look.redness += w * std::max(0.7 * knuckle, 0.6 * tip);
    if (!c.joined) continue;
    // Two lines, the second fainter, bowed a little and fading to the sides.
    const double line = s + 0.2 * c.radius * (1.0 - pulp);
    const double lines = std::exp(-std::pow(line / kCrease_m, 2.0)) +
                         0.5 * std::exp(-std::pow((line - 0.0026) / kCrease_m, 2.0));
    look.crease = std::max(look.crease, lines * std::min(w, 1.0) * smoothStep(0.1, 0.7, pulp));
  }
  look.redness /= weight;
  look.palmar = std::clamp(0.8 * normal.dot(palmar) / weight + 0.15, 0.0, 1.0);
  return look;
}

}  // namespace wholehand
