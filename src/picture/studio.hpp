#pragma once

#include "picture/diorama.hpp"
#include "picture/floor_shade.hpp"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace wholehand {

/// Linear light, red, green, blue.
using Color = Eigen::Array3d;

/// "#RRGGBB" to linear light; mid grey when it is not a colour.
[[nodiscard]] Color linearColor(const std::string& hex);
/// Linear light to sRGB 0 .. 1, by a shoulder that keeps hues and lets only highlights whiten.
[[nodiscard]] Color toneMapped(const Color& light);

/// A contact as light: where it glows and how wide.
struct Ember {
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  double force_n = 0.0;
};

/// Right-handed camera basis; every lamp hangs relative to it, so each view is lit as well.
struct CameraFrame {
  Eigen::Vector3d eye_m, right, up, forward;
};

/// Lamps and materials: says which colour a ray brings home.
class Studio {
 public:
  Studio(const Diorama& diorama, const CameraFrame& camera, std::vector<Ember> embers);

  /// @param u,v place in the picture, -1 .. 1 along its height (u wider), for the backdrop
  [[nodiscard]] Color trace(const Ray& ray, double u, double v, Hit& hit) const;

 private:
  struct Lit;
  [[nodiscard]] Color backdrop(double u, double v) const;
  [[nodiscard]] Color floor(const Eigen::Vector3d& p, const Color& beyond) const;
  [[nodiscard]] Color skin(const Lit& at) const;
  [[nodiscard]] Color plastic(const Lit& at, const Color& base) const;
  [[nodiscard]] Color cloth(const Lit& at, const Color& base) const;
  [[nodiscard]] Color ambient(const Eigen::Vector3d& normal) const;
  [[nodiscard]] Color reflected(const Eigen::Vector3d& direction) const;
  [[nodiscard]] double emberShare(const Eigen::Vector3d& p) const;

  const Diorama* diorama_;
  std::vector<Ember> embers_;
  std::vector<Color> body_color_;
  Eigen::Vector3d key_, rim_, window_, strip_;
  FloorShade floor_shade_;
};

}  // namespace wholehand
