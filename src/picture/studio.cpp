#include "picture/studio.hpp"

#include "picture/smooth.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;
constexpr double kKeySoftness = 0.16;  // tangent of the window's apparent radius

Color mix(const Color& a, const Color& b, double t) {
  return a + (b - a) * t;
}

double linear(double srgb) {
  return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

double srgb(double value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
}

Color rgb(int hex) {
  return {linear(((hex >> 16) & 255) / 255.0), linear(((hex >> 8) & 255) / 255.0),
          linear((hex & 255) / 255.0)};
}

/// Microfacet highlight (GGX with Smith's height-correlated masking) times cosine, F left out.
double highlight(double n_l, double n_v, double n_h, double roughness) {
  if (n_l <= 0.0 || n_v <= 0.0) return 0.0;
  const double a2 = std::pow(roughness, 4.0);
  const double d = n_h * n_h * (a2 - 1.0) + 1.0;
  const double distribution = a2 / (kPi * d * d);
  const double masking = 0.5 / (n_l * std::sqrt(n_v * n_v * (1.0 - a2) + a2) +
                                n_v * std::sqrt(n_l * n_l * (1.0 - a2) + a2));
  return distribution * masking * n_l;
}

double fresnel(double f0, double cosine) {
  return f0 + (1.0 - f0) * std::pow(std::clamp(1.0 - cosine, 0.0, 1.0), 5.0);
}

/// Direction to a lamp: to the camera's right, up in the world, and back towards the camera.
Vector3d lamp(const CameraFrame& camera, double right, double up, double back) {
  const Vector3d level_back = camera.right.cross(Vector3d::UnitZ());
  return (right * camera.right + up * Vector3d::UnitZ() + back * level_back).normalized();
}

const Color kKey = rgb(0xFFEFD9) * 2.40;
const Color kRim = rgb(0xCFE6EA) * 1.25;
const Color kSky = rgb(0xDCE4E2) * 0.66;
const Color kBounce = rgb(0xD2A684) * 0.42;

}  // namespace

/// What light meets at the end of a ray.
struct Studio::Lit {
  Vector3d point, normal, view;
  double key_shadow = 1.0, open = 1.0;
};

Color linearColor(const std::string& hex) {
  unsigned value = 0;
  if (hex.size() != 7 || hex[0] != '#' ||
      hex.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos) {
    return Color::Constant(0.2);
  }
  value = static_cast<unsigned>(std::stoul(hex.substr(1), nullptr, 16));
  return rgb(static_cast<int>(value));
}

Color toneMapped(const Color& light) {
  // Linear up to the shoulder; above it the peak approaches 1 and the colour bleaches slowly.
  constexpr double kShoulder = 0.72;
  Color c = light.max(0.0);
  const double peak = c.maxCoeff();
  if (peak > kShoulder) {
    const double room = 1.0 - kShoulder;
    const double mapped = 1.0 - room * room / (peak - kShoulder + room);
    c *= mapped / peak;
    c = mix(c, Color::Constant(mapped), 1.0 - 1.0 / (1.0 + 0.12 * (peak - mapped)));
  }
  return c.unaryExpr([](double x) { return srgb(std::min(x, 1.0)); });
}

Studio::Studio(const Diorama& diorama, const CameraFrame& camera, std::vector<Ember> embers)
    : diorama_(&diorama),
      embers_(std::move(embers)),
      key_(lamp(camera, -0.62, 0.85, 0.62)),
      rim_(lamp(camera, 0.80, 0.42, -0.55)),
      window_(lamp(camera, -0.75, 0.70, 0.75)),
      strip_(lamp(camera, 0.95, 0.30, 0.35)),
      floor_shade_(diorama, key_) {
  for (const SceneBody& b : diorama.scene().bodies) body_color_.push_back(linearColor(b.color));
}

Color Studio::backdrop(double u, double v) const {
  // A teal wall lit by a wide soft lamp behind the hand.
  const double r = std::hypot((u + 0.15) / 1.5, (v - 0.10) / 1.15);
  const Color light = rgb(0x5F8F94), dark = rgb(0x1E3B47);
  return mix(light, dark, smoothStep(0.0, 1.25, r));
}

Color Studio::floor(const Vector3d& p, const Color& beyond) const {
  const Vector3d up = Vector3d::UnitZ();
  const double open = diorama_->openness(p, up, 0.12);
  const Color key_part = Color(1.0, 0.98, 0.95) * (0.62 * floor_shade_.at(p));
  return beyond * (key_part + 0.46 * open);
}

Color Studio::ambient(const Vector3d& normal) const {
  return mix(kBounce, kSky, 0.5 + 0.5 * normal.z());
}

Color Studio::reflected(const Vector3d& direction) const {
  // A wide warm window to the left, a narrow cool strip to the right, a calm room.
  const auto pane = [&](const Vector3d& center, double half_width, double half_height) {
    const Vector3d side = Vector3d::UnitZ().cross(center).normalized();
    const Vector3d over = center.cross(side);
    const double facing = direction.dot(center);
    if (facing <= 0.05) return 0.0;
    const double x = std::abs(direction.dot(side)) / facing;
    const double y = std::abs(direction.dot(over)) / facing;
    return smoothStep(half_width + 0.10, half_width - 0.06, x) *
           smoothStep(half_height + 0.10, half_height - 0.06, y);
  };
  const Color room = mix(rgb(0x3C3A34), rgb(0x8FA6A8), smoothStep(-0.4, 1.0, direction.z()));
  return room * 0.5 + rgb(0xFFF0D8) * (3.4 * pane(window_, 0.30, 0.42)) +
         rgb(0xDBE9EA) * (1.3 * pane(strip_, 0.16, 0.60));
}

double Studio::emberShare(const Vector3d& p) const {
  double dark = 1.0;
  for (const Ember& e : embers_) {
    const double reach = 0.009 + 0.0022 * e.force_n;
    const double g = std::max(0.0, 1.0 - (p - e.point_m).norm() / reach);
    dark *= 1.0 - g * g;
  }
  return 1.0 - dark;
}

Color Studio::skin(const Lit& at) const {
  const SkinLook look = diorama_->skin().look(at.point, at.normal);
  Color base = mix(rgb(0xD3A084), rgb(0xE3B8A0), 0.75 * look.palmar);
  base = mix(base, base * Color(1.04, 0.74, 0.68), 0.55 * look.redness);
  base = mix(base, rgb(0x9C5F45), 0.42 * look.fold);
  base = mix(base, rgb(0x9C5F45), 0.48 * look.crease);
  base = mix(base, rgb(0xF0CDBE), look.nail);
  base = mix(base, rgb(0x9C5F45), 1.6 * look.nail * (1.0 - look.nail));  // the nail's fold

  const double n_l = at.normal.dot(key_);
  // Light that enters skin leaves it a little farther on, red the farthest: it wraps into shadow.
  const Color wrap(0.36, 0.17, 0.11);
  const Color diffuse = ((n_l + wrap) / (1.0 + wrap)).max(0.0) / (1.0 + 0.5 * wrap);
  const Color shadow(std::pow(at.key_shadow, 0.75), at.key_shadow, std::pow(at.key_shadow, 1.1));
  const Color open(std::pow(at.open, 0.80), at.open, std::pow(at.open, 1.08));
  // The softer normal may turn away from the eye at an outline; it must not flare there.
  const double n_v = std::max(0.12, at.normal.dot(at.view));
  const double edge = std::pow(1.0 - n_v, 3.0);
  const double rim = std::max(0.0, at.normal.dot(rim_) + 0.15) / 1.15;

  Color c = base * (diffuse * shadow * kKey * 0.62 + ambient(at.normal) * open +
                    kRim * (0.55 * rim * at.open));
  c += rgb(0xFFB59A) * (0.10 * edge * at.open * (0.4 + 0.6 * at.key_shadow));
  const double roughness = 0.50 - 0.24 * look.nail;
  const Vector3d half = (key_ + at.view).normalized();
  const double spec = highlight(n_l, n_v, at.normal.dot(half), roughness);
  c += kKey * (0.030 * spec * at.key_shadow * 0.9);
  const Vector3d mirrored = 2.0 * n_v * at.normal - at.view;
  c += reflected(mirrored) * (fresnel(0.028, n_v) * at.open * (0.22 + 0.5 * look.nail));
  const double glow = emberShare(at.point);
  return mix(c, rgb(0xFFE0A0) * 1.1, 0.85 * glow);
}

Color Studio::plastic(const Lit& at, const Color& base) const {
  const double n_l = std::max(0.0, at.normal.dot(key_));
  const double n_v = std::max(0.02, at.normal.dot(at.view));
  const double rim = std::max(0.0, at.normal.dot(rim_));
  Color c = base * (kKey * (0.62 * n_l * at.key_shadow) + ambient(at.normal) * at.open +
                    kRim * (0.4 * rim * at.open));
  const Vector3d half = (key_ + at.view).normalized();
  c += kKey * (0.04 * highlight(n_l, n_v, at.normal.dot(half), 0.42) * at.key_shadow * 0.6);
  const Vector3d mirrored = 2.0 * n_v * at.normal - at.view;
  c += reflected(mirrored) * (fresnel(0.04, n_v) * at.open * (0.35 + 0.65 * at.key_shadow));
  const double glow = emberShare(at.point);
  return mix(c, rgb(0xFFD27A), 0.55 * glow);
}

Color Studio::cloth(const Lit& at, const Color& base) const {
  const double n_l = at.normal.dot(key_);
  const double n_v = std::max(0.0, at.normal.dot(at.view));
  const double diffuse = std::max(0.0, (n_l + 0.12) / 1.12);
  const double rim = std::max(0.0, at.normal.dot(rim_));
  const double fuzz = std::pow(1.0 - n_v, 2.5);
  Color c = base * (kKey * (0.62 * diffuse * at.key_shadow) + ambient(at.normal) * at.open +
                    kRim * (0.4 * rim * at.open));
  return c + rgb(0xDFE6EA) * (0.12 * fuzz * at.open);
}

Color Studio::trace(const Ray& ray, double u, double v, Hit& hit) const {
  hit = diorama_->march(ray);
  const Color wall = backdrop(u, v);
  const auto behind = [&](const Ray& r) -> Color {
    const double t = (diorama_->floorHeight() - r.origin_m.z()) / r.direction.z();
    if (r.direction.z() >= 0.0 || t <= 0.0) return Color(wall);
    // The floor rises into the wall as in a photographer's cove.
    return mix(floor(r.at(t), wall), wall, smoothStep(0.9, 3.0, t));
  };
  if (hit.surface == Surface::kNothing || hit.surface == Surface::kFloor) return behind(ray);

  Lit at;
  at.point = ray.at(hit.t_m);
  at.normal = diorama_->normal(hit, at.point);
  at.view = -ray.direction;
  at.open = diorama_->openness(at.point, at.normal, 0.030);
  if (at.normal.dot(key_) > -0.4) {
    at.key_shadow = diorama_->shadow(at.point + 0.0006 * at.normal, key_, kKeySoftness);
  } else {
    at.key_shadow = 0.0;
  }
  switch (hit.surface) {
    case Surface::kSkin:
      return skin(at);
    case Surface::kCuff:
      return cloth(at, rgb(0xEFE7D8));
    case Surface::kCloth: {
      const double gone = diorama_->sleeve().dissolved(at.point);
      const Color c = gone < 1.0 ? cloth(at, rgb(0x4A5B68)) : Color(Color::Zero());
      return gone > 0.0 ? mix(c, behind(ray), gone) : c;
    }
    default:
      return plastic(at, body_color_[static_cast<std::size_t>(hit.body)]);
  }
}

}  // namespace wholehand
