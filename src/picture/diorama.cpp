#include "picture/diorama.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr double kTouch_m = 0.00004;  // a ray this close has arrived
constexpr int kMaxSteps = 200;
constexpr double kShadowStart_m = 0.0016;
constexpr double kFloorGap_m = 0.03;  // below the lowest thing
constexpr double kInPicture_m = 0.6;  // things farther from the target do not lower the floor
constexpr double kInf = std::numeric_limits<double>::infinity();

struct Ball {
  Vector3d center = Vector3d::Zero();
  double radius = 0.0;
};

/// A sphere around a shape, in the body's frame.
Ball boundOf(const Shape& shape) {
  switch (shape.type) {
    case ShapeType::kBox:
      return {shape.in_body.translation_m, shape.half_extents_m.norm()};
    case ShapeType::kSphere:
      return {shape.in_body.translation_m, shape.radius_m};
    case ShapeType::kCylinder:
      return {shape.in_body.translation_m, std::hypot(shape.radius_m, 0.5 * shape.length_m)};
    case ShapeType::kCapsule:
      return {shape.in_body.translation_m, shape.radius_m + 0.5 * shape.length_m};
    case ShapeType::kConvexMesh:
      break;
  }
  Vector3d low = Vector3d::Constant(kInf), high = -low;
  for (const Vector3d& p : shape.points_m) {
    low = low.cwiseMin(shape.in_body * p);
    high = high.cwiseMax(shape.in_body * p);
  }
  return {0.5 * (low + high), 0.5 * (high - low).norm()};
}

Ball boundOf(const SceneBody& body) {
  Ball all;
  for (const Shape& s : body.shapes) {
    all.center += boundOf(s).center / static_cast<double>(body.shapes.size());
  }
  for (const Shape& s : body.shapes) {
    const Ball one = boundOf(s);
    all.radius = std::max(all.radius, (one.center - all.center).norm() + one.radius);
  }
  return all;
}

/// The lowest value of a function given at growing places: between three of them that dip, that of
/// the parabola through them, so that the steps of a ray leave no bands in a shadow.
class Passage {
 public:
  double lowest(double t, double f) noexcept {
    t0_ = t1_, f0_ = f1_;
    t1_ = t2_, f1_ = f2_;
    t2_ = t, f2_ = f;
    if (++seen_ < 3 || f1_ > f0_ || f1_ > f2_ || f1_ > 1.0) return f;
    const double left = (f1_ - f0_) / (t1_ - t0_), right = (f2_ - f1_) / (t2_ - t1_);
    const double bend = (right - left) / (t2_ - t0_);
    if (!(bend > 0.0)) return f1_;
    const double slope = left + bend * (t1_ - t0_);  // of the parabola at t1
    return f1_ - slope * slope / (4.0 * bend);
  }

 private:
  double t0_ = 0.0, t1_ = 0.0, t2_ = 0.0, f0_ = 0.0, f1_ = 0.0, f2_ = 0.0;
  int seen_ = 0;
};

}  // namespace

Diorama::Diorama(SkinField skin, Sleeve sleeve, const SceneModel& scene,
                 const std::vector<BodyState>& bodies, const Vector3d& target_m)
    : skin_(std::move(skin)), sleeve_(std::move(sleeve)), scene_(&scene), target_m_(target_m) {
  if (!skin_.empty()) things_.push_back({skin_.center(), skin_.radius(), Surface::kSkin, -1});
  if (!sleeve_.empty()) {
    things_.push_back({sleeve_.center(), sleeve_.radius(), Surface::kCuff, -1});
    things_.push_back({sleeve_.center(), sleeve_.radius(), Surface::kCloth, -1});
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    addBody(scene.bodies[i], bodies[i], static_cast<int>(i));
  }
  layFloor();
}

void Diorama::addBody(const SceneBody& body, const BodyState& state, int index) {
  Pose pose;
  pose.rotation = state.orientation_xyzw.eigen().normalized().toRotationMatrix();
  pose.translation_m = state.position_m.eigen() - pose.rotation * body.com_m;
  to_body_.push_back(pose.inverse());
  const Ball ball = boundOf(body);
  things_.push_back({pose * ball.center, ball.radius, Surface::kBody, index});
}

bool Diorama::inPicture(const Thing& t) const {
  return (t.center - target_m_).norm() < kInPicture_m;
}

void Diorama::layFloor() {
  double lowest = target_m_.z() - 0.06;
  for (const Thing& t : things_) {
    if (t.surface == Surface::kCuff || t.surface == Surface::kCloth || !inPicture(t)) continue;
    lowest = std::min(lowest, t.center.z() - t.radius);
  }
  floor_m_ = lowest - kFloorGap_m;
}

std::pair<Eigen::Vector2d, double> Diorama::shadowArea(const Vector3d& to_lamp,
                                                       double softness) const {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(kInf), high = -low;
  for (const Thing& t : things_) {
    const double height = t.center.z() - floor_m_;
    if (!inPicture(t) || height < 0.0) continue;
    const Vector3d foot = t.center - to_lamp * (height / to_lamp.z());
    const double reach = (t.radius + softness * height / to_lamp.z()) / to_lamp.z();
    low = low.cwiseMin(foot.head<2>() - Eigen::Vector2d::Constant(reach));
    high = high.cwiseMax(foot.head<2>() + Eigen::Vector2d::Constant(reach));
  }
  if (!(low.x() <= high.x())) return {Eigen::Vector2d::Zero(), 0.0};
  return {0.5 * (low + high), 0.5 * (high - low).maxCoeff()};
}

double Diorama::body(int index, const Vector3d& p_m) const noexcept {
  const auto i = static_cast<std::size_t>(index);
  const Vector3d local = to_body_[i] * p_m;
  double d = kInf;
  for (const Shape& s : scene_->bodies[i].shapes) d = std::min(d, signedDistance(s, local));
  return d;
}

double Diorama::thing(const Thing& t, const Vector3d& p_m) const noexcept {
  const double outside = (p_m - t.center).norm() - t.radius;
  if (outside > 0.02) return outside;
  return t.surface == Surface::kSkin ? skin_.skin(p_m) : whole(t, p_m);
}

double Diorama::whole(const Thing& t, const Vector3d& p_m) const noexcept {
  switch (t.surface) {
    case Surface::kSkin:
      return skin_.estimate(p_m);
    case Surface::kCuff:
      return sleeve_.cuff(p_m);
    case Surface::kCloth:
      return sleeve_.cloth(p_m);
    default:
      return body(t.body, p_m);
  }
}

double Diorama::nearest(Mask mask, const Vector3d& p_m, std::size_t& which) const noexcept {
  double d = kInf;
  for (; mask != 0; mask &= mask - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(mask));
    const double one = thing(things_[i], p_m);
    if (one < d) {
      d = one;
      which = i;
    }
  }
  return d;
}

/// The things whose sphere, widened with distance like a penumbra, a ray enters.
Diorama::Span Diorama::span(const Ray& ray, double margin_m, double softness) const noexcept {
  Span span{0, kInf, 0.0};
  for (std::size_t i = 0; i < things_.size(); ++i) {
    const Vector3d to_center = things_[i].center - ray.origin_m;
    const double along = to_center.dot(ray.direction);
    const double radius = things_[i].radius + margin_m + softness * std::max(along, 0.0);
    const double off2 = to_center.squaredNorm() - along * along;
    if (off2 > radius * radius) continue;
    const double half = std::sqrt(radius * radius - off2);
    if (along + half <= 0.0) continue;
    span.mask |= Mask{1} << i;
    span.near_m = std::min(span.near_m, std::max(0.0, along - half));
    span.far_m = std::max(span.far_m, along + half);
  }
  return span;
}

Hit Diorama::march(const Ray& ray) const noexcept {
  const double to_floor = (floor_m_ - ray.origin_m.z()) / ray.direction.z();
  Hit hit;
  if (ray.direction.z() < 0.0 && to_floor > 0.0) hit = {Surface::kFloor, -1, to_floor};
  const Span s = span(ray, 0.0, 0.0);
  const double end = hit.surface == Surface::kFloor ? std::min(s.far_m, to_floor) : s.far_m;
  double t = s.near_m;
  for (int i = 0; s.mask != 0 && i < kMaxSteps && t < end; ++i) {
    std::size_t which = 0;
    const double d = nearest(s.mask, ray.at(t), which);
    if (d < kTouch_m) return {things_[which].surface, things_[which].body, t};
    t += std::max(0.97 * d, kTouch_m);
  }
  return hit;
}

double Diorama::shadow(const Vector3d& p_m, const Vector3d& to_light,
                       double softness) const noexcept {
  const Ray ray{p_m, to_light};
  const Span s = span(ray, 0.0, softness);
  double light = 1.0, t = std::max(kShadowStart_m, s.near_m);
  Passage passage;
  for (int i = 0; s.mask != 0 && i < 120 && t < s.far_m; ++i) {
    // The nearest passage over the distance travelled says how much of the lamp is covered; it may
    // go negative, so that the penumbra lies on both sides of the geometric shadow's edge.
    double d = kInf;
    const Vector3d p = ray.at(t);
    for (Mask m = s.mask; m != 0; m &= m - 1) {
      const Thing& one = things_[static_cast<std::size_t>(std::countr_zero(m))];
      // A bound will do where the whole lamp is seen past the thing.
      const double outside = (p - one.center).norm() - one.radius;
      d = std::min(d, outside > 1.5 * softness * t ? outside : whole(one, p));
    }
    light = std::min(light, passage.lowest(t, d / (softness * t)));
    if (light < -1.0) break;
    t += std::clamp(0.5 * std::abs(d), 0.0005 + 0.004 * t, 0.03);
  }
  light = std::clamp(light, -1.0, 1.0);
  return 0.25 * (1.0 + light) * (1.0 + light) * (2.0 - light);
}

double Diorama::openness(const Vector3d& p_m, const Vector3d& normal,
                         double reach_m) const noexcept {
  Mask near = 0;
  for (std::size_t i = 0; i < things_.size(); ++i) {
    if ((things_[i].center - p_m).norm() < things_[i].radius + 2.0 * reach_m) near |= Mask{1} << i;
  }
  double covered = 0.0, weight = 0.0;
  for (int i = 1; near != 0 && i <= 6; ++i) {
    const double h = reach_m * i * i / 36.0 + 0.001;
    const Vector3d q = p_m + h * normal;
    double d = h;
    for (Mask m = near; m != 0; m &= m - 1) {
      const Thing& t = things_[static_cast<std::size_t>(std::countr_zero(m))];
      if ((q - t.center).norm() - t.radius >= d) continue;
      d = std::min(d, t.surface == Surface::kSkin ? skin_.roughly(q) : whole(t, q));
    }
    const double w = 1.0 / (1.0 + 0.35 * i);
    covered += w * std::clamp((h - d) / h, 0.0, 1.0);
    weight += w;
  }
  return near == 0 ? 1.0 : 1.0 - covered / weight;
}

Vector3d Diorama::normal(const Hit& hit, const Vector3d& p_m) const noexcept {
  if (hit.surface == Surface::kFloor) return Vector3d::UnitZ();
  if (hit.surface == Surface::kSkin) return skin_.lightNormal(p_m);
  // Wide differences round a sharp edge for the light, as moulded plastic is round.
  const double h = 0.0005;
  Vector3d g;
  for (int i = 0; i < 3; ++i) {
    const Vector3d e = h * Vector3d::Unit(i);
    const auto field = [&](const Vector3d& q) {
      if (hit.surface == Surface::kCuff) return sleeve_.cuff(q);
      if (hit.surface == Surface::kCloth) return sleeve_.cloth(q);
      return body(hit.body, q);
    };
    g[i] = field(p_m + e) - field(p_m - e);
  }
  return g.normalized();
}

}  // namespace wholehand
