#pragma once

#include <array>

namespace wholehand::bullet {

inline constexpr int kMostCorners = 64;

/// A corner of a patch: (u, v) in the plane perpendicular to the direction, and its height along
/// the direction.
struct Corner {
  double u, v, height_m;
};

/// Squared distance from the world's origin. It decides among equal corners, so that a mirrored
/// world has the mirrored points in the same order.
[[nodiscard]] inline double awayFromOrigin(const Corner& at) noexcept {
  return at.u * at.u + at.v * at.v + at.height_m * at.height_m;
}

/// A convex polygon (counter-clockwise), an edge, or a point.
struct Outline {
  std::array<Corner, 2 * kMostCorners> corners;
  int count = 0;

  void add(const Corner& corner) noexcept {
    if (count < static_cast<int>(corners.size())) corners[count++] = corner;
  }
};

/// Twice the area of a triangle; positive if its corners run counter-clockwise.
[[nodiscard]] inline double turnOf(const Corner& a, const Corner& b, const Corner& c) noexcept {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

/// Height of an outline's plane, line or point over (u, v).
class Ground {
 public:
  explicit Ground(const Outline& of) : at_(of.corners[0]) {
    if (of.count == 2) {
      const Corner& end = of.corners[1];
      const double u = end.u - at_.u, v = end.v - at_.v, length2 = u * u + v * v;
      if (length2 > 0.0) {
        const double slope = (end.height_m - at_.height_m) / length2;
        du_ = slope * u, dv_ = slope * v;
      }
    } else if (of.count > 2) {
      double nu = 0.0, nv = 0.0, nh = 0.0;  // normal by Newell's method
      for (int i = 0; i < of.count; ++i) {
        const Corner& a = of.corners[i];
        const Corner& b = of.corners[(i + 1) % of.count];
        nu += (a.v - b.v) * (a.height_m + b.height_m - 2.0 * at_.height_m);
        nv += (a.height_m - b.height_m) * (a.u + b.u - 2.0 * at_.u);
        nh += (a.u - b.u) * (a.v + b.v - 2.0 * at_.v);
      }
      du_ = -nu / nh, dv_ = -nv / nh;
    }
  }
  [[nodiscard]] double height(const Corner& over) const {
    return at_.height_m + du_ * (over.u - at_.u) + dv_ * (over.v - at_.v);
  }

 private:
  Corner at_;
  double du_ = 0.0, dv_ = 0.0;
};

/// The part of an outline that lies within a polygon. Real-time safe.
[[nodiscard]] Outline clip(Outline of, const Outline& within) noexcept;
/// The common part of two edges, or of an edge and a point. Real-time safe.
[[nodiscard]] Outline commonOf(const Outline& a, const Outline& b) noexcept;

}  // namespace wholehand::bullet
