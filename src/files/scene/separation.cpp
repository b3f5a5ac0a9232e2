#include "files/scene/separation.hpp"

#include <Eigen/Geometry>
#include <Eigen/QR>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Eigen::Vector3d;

constexpr double kTiny_m = 1e-10;  ///< cores nearer than this count as overlapping
constexpr double kGain_m = 1e-9;   ///< the expansion ends when it gains less
constexpr int kMaxSteps = 256;

/// A shape without its ball: a sphere becomes a point, a capsule a segment.
struct Core {
  const Shape& shape;
  Pose world;

  /// The farthest point in a world direction.
  [[nodiscard]] Vector3d support(const Vector3d& direction) const {
    return world * coreSupport(shape, world.rotation.transpose() * direction);
  }
};

/// The Minkowski difference a − b of two cores: they overlap exactly if it contains the origin.
struct Difference {
  Core a, b;

  [[nodiscard]] Vector3d support(const Vector3d& direction) const {
    // The direction is tilted slightly, so that ties between equally far points are resolved alike
    // in both cores. The result is then a true vertex of the difference. Vertices are never
    // collinear, which the expansion requires.
    const Vector3d d = direction.normalized() + 1e-9 * Vector3d(0.61, 0.74, 0.28);
    return a.support(d) - b.support(-d);
  }
};

/// Up to four vertices, and the point of their hull nearest to the origin.
struct Simplex {
  std::array<Vector3d, 4> points;
  int size = 0;
  Vector3d nearest = Vector3d::Zero();
};

/// Finds the point of the subset `mask` of a simplex nearest to the origin; returns false when it
/// lies outside the subset.
bool nearestOfSubset(const Simplex& s, unsigned mask, Simplex& subset) {
  subset.size = 0;
  for (int i = 0; i < s.size; ++i) {
    if ((mask >> i) & 1U) subset.points[subset.size++] = s.points[i];
  }
  const Vector3d& base = subset.points[0];
  subset.nearest = base;
  if (subset.size == 1) return true;
  using Edges = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, 3>;
  Edges edges(3, subset.size - 1);
  for (int i = 1; i < subset.size; ++i) edges.col(i - 1) = subset.points[i] - base;
  const Eigen::ColPivHouseholderQR<Edges> qr(edges);
  if (qr.rank() < subset.size - 1) return false;  // degenerate: a smaller subset spans it
  const Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 3, 1> weights = qr.solve(-base);
  if (weights.minCoeff() < 0.0 || weights.sum() > 1.0) return false;
  subset.nearest = base + edges * weights;
  return true;
}

/// Reduces a simplex to the vertices that span its point nearest to the origin. Testing all subsets
/// costs a few microseconds and has no special cases.
Simplex reduced(const Simplex& s) {
  Simplex best;
  double best_m2 = std::numeric_limits<double>::infinity();
  for (unsigned mask = 1; mask < (1U << s.size); ++mask) {
    Simplex subset;
    if (!nearestOfSubset(s, mask, subset)) continue;
    const double m2 = subset.size == 4 ? 0.0 : subset.nearest.squaredNorm();
    if (m2 < best_m2) {
      best_m2 = m2;
      best = subset;
    }
  }
  return best;
}

/// Distance of the origin from the difference (Gilbert, Johnson, Keerthi 1988); 0 inside.
double originDistance(const Difference& difference) {
  Simplex s;
  s.points[0] = difference.support(Vector3d::UnitX());
  s.size = 1;
  s.nearest = s.points[0];
  double distance_m = s.nearest.norm();
  for (int step = 0; step < kMaxSteps && distance_m > kTiny_m; ++step) {
    const Vector3d w = difference.support(-s.nearest);
    // No vertex lies further towards the origin: the nearest point is found.
    if (distance_m - s.nearest.dot(w) / distance_m < 1e-12) break;
    s.points[s.size++] = w;
    const Simplex next = reduced(s);
    if (next.size == 4) return 0.0;
    const double next_m = next.nearest.norm();
    if (!(next_m < distance_m)) break;  // no further progress because of rounding
    s = next;
    distance_m = next_m;
  }
  return distance_m > kTiny_m ? distance_m : 0.0;
}

struct Face {
  std::array<int, 3> corner;
  Vector3d normal;    ///< unit, outward
  double distance_m;  ///< distance of the origin, positive inside
};

/// A polytope inside the difference that grows until its face nearest to the origin lies on the
/// difference's own surface (expanding polytope, van den Bergen 2001).
class Polytope {
 public:
  explicit Polytope(const Difference& difference) : difference_(difference) {}

  /// Penetration depth [m]: the least translation that moves the origin outside; 0 for a difference
  /// without volume.
  double depth() {
    if (!start()) return 0.0;
    double depth_m = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMaxSteps; ++step) {
      const Face nearest = *std::min_element(
          faces_.begin(), faces_.end(),
          [](const Face& f, const Face& g) { return f.distance_m < g.distance_m; });
      const Vector3d w = difference_.support(nearest.normal);
      // Every supporting plane bounds the depth from above, the nearest face from below.
      depth_m = std::min(depth_m, nearest.normal.dot(w));
      if (depth_m - nearest.distance_m < kGain_m) break;
      expand(w);
    }
    return std::max(depth_m, 0.0);
  }

 private:
  /// Finds a first tetrahedron with volume; false when the difference has none.
  bool start() {
    const Vector3d a = difference_.support(Vector3d::UnitX());
    Vector3d b = a;
    for (int i = 0; i < 6; ++i) b = farther(a, b, difference_.support(sign(i) * axis(i / 2)));
    if ((b - a).norm() < kGain_m) return false;
    const Vector3d along = (b - a).normalized();
    const Vector3d u = along.unitOrthogonal();
    const std::array<Vector3d, 2> across{u, along.cross(u)};
    Vector3d c = a;
    double off_m = 0.0;
    for (int i = 0; i < 4; ++i) {
      const Vector3d w = difference_.support(sign(i) * across[i / 2]);
      const double w_off_m = along.cross(w - a).norm();
      if (w_off_m > off_m) std::tie(off_m, c) = std::pair(w_off_m, w);
    }
    if (off_m < kGain_m) return false;
    const Vector3d normal = along.cross(c - a).normalized();
    const Vector3d above = difference_.support(normal), below = difference_.support(-normal);
    const bool up = std::abs(normal.dot(above - a)) > std::abs(normal.dot(below - a));
    const Vector3d d = up ? above : below;
    if (std::abs(normal.dot(d - a)) < kGain_m) return false;
    points_ = {a, b, c, d};
    inside_ = (a + b + c + d) / 4.0;
    addFace(0, 1, 2);
    addFace(0, 1, 3);
    addFace(0, 2, 3);
    addFace(1, 2, 3);
    return true;
  }

  static double sign(int i) { return i % 2 == 0 ? 1.0 : -1.0; }
  static Vector3d axis(int i) { return Vector3d::Unit(i); }
  static Vector3d farther(const Vector3d& from, const Vector3d& p, const Vector3d& q) {
    return (q - from).squaredNorm() > (p - from).squaredNorm() ? q : p;
  }

  void addFace(int i, int j, int k) {
    const Vector3d& p = points_[i];
    Vector3d normal = (points_[j] - p).cross(points_[k] - p).normalized();
    if (normal.dot(p - inside_) < 0.0) {
      normal = -normal;
      std::swap(j, k);
    }
    faces_.push_back({{i, j, k}, normal, normal.dot(p)});
  }

  /// Adds a farther vertex and replaces the faces that face it by a fan around it.
  void expand(const Vector3d& w) {
    const auto sees = [&](const Face& f) { return f.normal.dot(w) - f.distance_m > 1e-12; };
    std::vector<std::pair<int, int>> edges;
    for (const Face& f : faces_) {
      if (!sees(f)) continue;
      for (int e = 0; e < 3; ++e) edges.emplace_back(f.corner[e], f.corner[(e + 1) % 3]);
    }
    std::erase_if(faces_, sees);
    points_.push_back(w);
    const int top = static_cast<int>(points_.size()) - 1;
    for (const auto& [i, j] : edges) {
      const bool inner = std::find(edges.begin(), edges.end(), std::pair(j, i)) != edges.end();
      if (!inner) addFace(i, j, top);
    }
  }

  const Difference& difference_;
  std::vector<Vector3d> points_;
  std::vector<Face> faces_;
  Vector3d inside_ = Vector3d::Zero();
};

}  // namespace

double separation(const Shape& a, const Pose& body_a, const Shape& b, const Pose& body_b) {
  const Difference difference{{a, body_a * a.in_body}, {b, body_b * b.in_body}};
  const double radii_m = a.ball_m() + b.ball_m();
  const double apart_m = originDistance(difference);
  if (apart_m > 0.0) return apart_m - radii_m;
  return -Polytope(difference).depth() - radii_m;
}

double separation(const SceneBody& a, const SceneBody& b) {
  double smallest_m = std::numeric_limits<double>::infinity();
  for (const Shape& s : a.shapes) {
    for (const Shape& t : b.shapes) {
      smallest_m = std::min(smallest_m, separation(s, a.pose, t, b.pose));
    }
  }
  return smallest_m;
}

}  // namespace wholehand
