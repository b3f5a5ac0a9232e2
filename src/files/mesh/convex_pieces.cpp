#include "files/mesh/convex_pieces.hpp"

#include "files/mesh/convex_hull.hpp"
#include "files/mesh/convex_mesh.hpp"
#include "files/mesh/mesh_checks.hpp"
#include "files/mesh/mesh_file.hpp"
#include "files/mesh/solid.hpp"
#include "loop/model/principal_axes.hpp"
#include "loop/model/scene_model.hpp"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3i;

// Measures of how well convex pieces approximate a solid. Distances are measured at points on the
// triangles that are at most a fortieth of the solid's size apart. Not real-time safe.

constexpr int kSamplesAcross = 40;  ///< sample points on a surface per size of the solid

/// Calls `take` with points on a triangle, about `apart_m` from each other.
template <class Take>
void forSamples(const Vector3d& a, const Vector3d& b, const Vector3d& c, double apart_m,
                Take take) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const int n = std::max(2, static_cast<int>(std::ceil(longest / apart_m)));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) take(a + (i * (b - a) + j * (c - a)) / n);
  }
}

/// Largest distance of a piece's surface outside the solid [m]; distances below `small_m` count as
/// 0.
/// @param distance to the solid's surface
double farthestOutside(const MeshSurface& piece, const ClosedSurface& solid,
                       const SurfaceDistance& distance, double small_m) {
  std::vector<std::pair<double, Vector3d>> far;
  for (const Vector3i& t : piece.triangles) {
    forSamples(piece.points[t[0]], piece.points[t[1]], piece.points[t[2]],
               solid.size_m / kSamplesAcross, [&](const Vector3d& p) {
                 if (const double d = distance.to(p); d > small_m) far.emplace_back(d, p);
               });
  }
  std::sort(far.begin(), far.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [d, p] : far) {
    if (distance.windings(p) < 0.5) return d;
  }
  return 0.0;
}

/// Largest distance of the solid's surface outside all pieces [m].
/// @param pieces the surfaces of all pieces, combined into one
double farthestMissing(const ClosedSurface& solid, const MeshSurface& pieces) {
  const SurfaceDistance distance(pieces);
  double farthest = 0.0;
  for (const Vector3i& t : solid.surface.triangles) {
    const auto& points = solid.surface.points;
    forSamples(points[t[0]], points[t[1]], points[t[2]], solid.size_m / kSamplesAcross,
               [&](const Vector3d& p) {
                 const double d = distance.to(p);
                 if (d > farthest && distance.windings(p) < 0.5) farthest = d;
               });
  }
  return farthest;
}

/// Volume that two convex pieces share [m³].
/// @param snap_m points nearer than this to a plane lie on it
double overlapOf(const MeshSurface& a, const MeshSurface& b, double snap_m) {
  std::vector<Facet> facets;
  for (const Vector3i& t : a.triangles) {
    facets.push_back({{a.points[t[0]], a.points[t[1]], a.points[t[2]]}, false});
  }
  for (const Vector3i& t : b.triangles) {
    const Vector3d area = (b.points[t[1]] - b.points[t[0]]).cross(b.points[t[2]] - b.points[t[0]]);
    if (!(area.norm() > 0.0) || facets.empty()) continue;
    const Vector3d normal = area.normalized();
    facets = cutBehind(facets, {normal, normal.dot(b.points[t[0]])}, snap_m);
  }
  return std::max(volumeOf(facets), 0.0);
}

/// Share of triangles whose both sides are inside the solid, from a sample of about 200.
/// @param distance to the solid's surface
double shareInside(const ClosedSurface& solid, const SurfaceDistance& distance) {
  const auto& s = solid.surface;
  const std::size_t step = s.triangles.size() / 200 + 1;
  int inside = 0, count = 0;
  for (std::size_t i = 0; i < s.triangles.size(); i += step) {
    const Vector3i& t = s.triangles[i];
    const Vector3d &a = s.points[t[0]], &b = s.points[t[1]], &c = s.points[t[2]];
    const Vector3d normal = (b - a).cross(c - a).normalized();
    const Vector3d above = (a + b + c) / 3.0 + 1e-6 * solid.size_m * normal;
    inside += distance.windings(above) > 0.5 ? 1 : 0;
    ++count;
  }
  return static_cast<double>(inside) / count;
}

constexpr int kPartsForPiece = 4;       ///< number of parts cut before merging, per allowed piece
constexpr int kCutsAlongDirection = 7;  ///< number of positions tried along each direction
constexpr double kSnapShare = 1e-9;  ///< share of the size; corners nearer to a cut plane lie on it
/// Share of the size; points nearer to the surface lie on it.
constexpr double kOnSurfaceShare = 1e-7;
/// Share of the solid's volume; smaller differences are ignored.
constexpr double kVolumeShare = 1e-6;
/// Weight of unequal halves in the cost of a cut, against its volume.
constexpr double kBalanceWeight = 0.01;
constexpr double kReflexWeight = 0.05;  ///< weight of reflex edges on the cut, against its volume
constexpr double kSmallGain = 0.02;  ///< cuts that gain less are also judged by the cuts after them
constexpr std::size_t kCutsAhead = 12;  ///< maximum number of cuts judged by the cuts after them
/// Relative: costs nearer than this are equal, and the first cut is taken.
constexpr double kTie = 1e-6;

/// The part of the solid inside a convex cell.
struct Part {
  std::vector<Facet> facets;
  std::vector<CutPlane> cell;      ///< the part is behind each of these
  std::vector<Vector3d> points_m;  ///< points whose convex hull is `hull`
  MeshSurface hull;
  double excess_m3 = 0.0;  ///< volume of the hull minus volume of the part
  bool done = false;
};

struct Cut {
  CutPlane plane;
  double cost = 0.0;  ///< costOf() minus the reward for reflex edges
};

struct Piece {
  MeshSurface hull;
  double volume_m3 = 0.0;
};

bool isBefore(const Vector3d& a, const Vector3d& b) {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
}

void sortUnique(std::vector<Vector3d>& points) {
  std::sort(points.begin(), points.end(), isBefore);
  points.erase(std::unique(points.begin(), points.end()), points.end());
}

class Decomposition {
 public:
  Decomposition(const ClosedSurface& solid, const PieceOptions& options)
      : solid_(solid),
        options_(options),
        distance_(solid.surface),
        features_(featurePlanes(solid.surface)),
        snap_m_(kSnapShare * solid.size_m) {}

  Expected<ConvexPieces> compute() {
    if (auto fault = cutSolid()) return *fault;
    mergePieces();
    ConvexPieces result;
    for (const Piece& piece : pieces_) {
      auto hull = reducedHull(piece.hull.points, options_.most_vertices);
      if (!hull) continue;  // thinner than the rounding of its coordinates to floats
      result.pieces_m3 += signedVolume(*hull);
      result.pieces.push_back(std::move(*hull));
    }
    if (result.pieces.empty()) {
      return fileFault("", "is too thin for convex pieces", "give it a thickness");
    }
    measure(result);
    return result;
  }

 private:
  [[nodiscard]] double outside(const MeshSurface& hull, double small_m) const {
    return farthestOutside(hull, solid_, distance_, small_m);
  }

  /// True inside the solid, and on its surface: a cut along a face may end there.
  [[nodiscard]] bool holds(const Vector3d& p) const {
    return distance_.to(p) <= kOnSurfaceShare * solid_.size_m || distance_.windings(p) > 0.5;
  }

  /// Corners of a cell inside the solid, where `plane` meets two others.
  [[nodiscard]] std::vector<Vector3d> innerCorners(const std::vector<CutPlane>& cell,
                                                   const CutPlane& plane,
                                                   const Eigen::AlignedBox3d& box) const {
    std::vector<Vector3d> corners;
    for (std::size_t i = 0; i < cell.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        Matrix3d normals;
        normals << plane.normal.transpose(), cell[i].normal.transpose(), cell[j].normal.transpose();
        if (std::abs(normals.determinant()) < 1e-6) continue;
        const Vector3d p =
            normals.inverse() * Vector3d(plane.offset_m, cell[i].offset_m, cell[j].offset_m);
        if (!box.contains(p)) continue;
        const bool within = std::all_of(cell.begin(), cell.end(), [&](const CutPlane& c) {
          return c.distance_m(p) <= snap_m_;
        });
        if (within && holds(p)) corners.push_back(p);
      }
    }
    return corners;
  }

  /// Points of the part behind the plane, without the inner corners.
  [[nodiscard]] std::vector<Vector3d> pointsBehind(const Part& part, const CutPlane& plane) const {
    std::vector<Vector3d> points;
    for (const Vector3d& p : part.points_m) {
      if (plane.distance_m(p) <= snap_m_) points.push_back(p);
    }
    for (const Facet& facet : part.facets) {
      if (facet.on_cut) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3d &a = facet.corners_m[k], &b = facet.corners_m[(k + 1) % 3];
        const double da = plane.distance_m(a), db = plane.distance_m(b);
        if ((da < -snap_m_ && db > snap_m_) || (da > snap_m_ && db < -snap_m_)) {
          points.push_back(crossing(a, da, b, db));
        }
      }
    }
    return points;
  }

  /// Share of the hull's volume that remains after the cut, plus a penalty for unequal halves.
  [[nodiscard]] double costOf(const Part& part, const CutPlane& plane,
                              const Eigen::AlignedBox3d& box) const {
    const std::vector<Vector3d> inner = innerCorners(part.cell, plane, box);
    std::array<double, 2> volume_m3{};
    for (std::size_t side = 0; side < 2; ++side) {
      std::vector<Vector3d> points = pointsBehind(part, side == 0 ? plane : plane.turned());
      points.insert(points.end(), inner.begin(), inner.end());
      const auto hull = convexHull(points);
      if (!hull) return std::numeric_limits<double>::infinity();
      volume_m3[side] = signedVolume(*hull);
    }
    const double whole_m3 = signedVolume(part.hull);
    return (volume_m3[0] + volume_m3[1] + kBalanceWeight * std::abs(volume_m3[0] - volume_m3[1])) /
           whole_m3;
  }

  /// Directions of cuts: the axes, and the principal axes of the part's hull.
  static std::vector<Vector3d> directionsOf(const Part& part) {
    std::vector<Vector3d> directions{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
    const Matrix3d inertia = moments(shapeOf(part.hull)).inertia_m5;
    const Matrix3d axes = principalAxesOf(inertia / inertia.trace()).axes;
    for (int i = 0; i < 3; ++i) directions.emplace_back(axes.col(i));
    return directions;
  }

  [[nodiscard]] std::vector<Candidate> candidates(const Part& part) const {
    std::vector<Candidate> planes = candidatesAtEdges(features_, part.cell, solid_.size_m);
    for (const Vector3d& direction : directionsOf(part)) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (const Vector3d& p : part.hull.points) {
        low = std::min(low, direction.dot(p));
        high = std::max(high, direction.dot(p));
      }
      for (int k = 1; k <= kCutsAlongDirection; ++k) {
        const double offset_m = low + (high - low) * k / (kCutsAlongDirection + 1);
        planes.push_back({{direction, offset_m}, 0.0});
      }
    }
    return planes;
  }

  /// The part behind a plane. Empty: nothing lies behind it, or a flat remainder.
  [[nodiscard]] std::optional<Part> partBehind(const Part& part, const CutPlane& plane,
                                               const std::vector<Vector3d>& inner) const {
    Part half;
    half.facets = cutBehind(part.facets, plane, snap_m_);
    half.cell = part.cell;
    half.cell.push_back(plane);
    half.points_m = pointsBehind(part, plane);
    half.points_m.insert(half.points_m.end(), inner.begin(), inner.end());
    return complete(std::move(half));
  }

  static std::optional<Part> complete(Part part) {
    sortUnique(part.points_m);
    auto hull = convexHull(part.points_m);
    if (!hull) return std::nullopt;
    part.hull = std::move(*hull);
    part.excess_m3 = signedVolume(part.hull) - volumeOf(part.facets);
    return part;
  }

  /// Bounding box of a part's hull, slightly enlarged.
  [[nodiscard]] Eigen::AlignedBox3d boxOf(const Part& part) const {
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : part.hull.points) box.extend(p);
    box.min().array() -= kOnSurfaceShare * solid_.size_m;
    box.max().array() += kOnSurfaceShare * solid_.size_m;
    return box;
  }

  /// All cuts that leave two hulls, the cheapest first.
  [[nodiscard]] std::vector<Cut> cutsOf(const Part& part) const {
    const Eigen::AlignedBox3d box = boxOf(part);
    std::vector<Cut> cuts;
    for (const Candidate& candidate : candidates(part)) {
      const double cost =
          costOf(part, candidate.plane, box) - kReflexWeight * candidate.reflex_share;
      if (std::isfinite(cost)) cuts.push_back({candidate.plane, cost});
    }
    std::stable_sort(cuts.begin(), cuts.end(),
                     [](const Cut& a, const Cut& b) { return a.cost < b.cost; });
    return cuts;
  }

  /// Both parts of a cut. Empty: one of them has no volume.
  [[nodiscard]] std::optional<std::pair<Part, Part>> halvesOf(const Part& part,
                                                              const CutPlane& plane) const {
    const std::vector<Vector3d> inner = innerCorners(part.cell, plane, boxOf(part));
    auto behind = partBehind(part, plane, inner), ahead = partBehind(part, plane.turned(), inner);
    if (!behind || !ahead) return std::nullopt;
    return std::pair(std::move(*behind), std::move(*ahead));
  }

  /// Volume of the hulls after this cut and the best cut of each half [m³].
  [[nodiscard]] double volumeAfterNextCuts(const Part& part, const CutPlane& plane) const {
    const auto halves = halvesOf(part, plane);
    if (!halves) return std::numeric_limits<double>::infinity();
    double volume_m3 = 0.0;
    for (const Part* half : {&halves->first, &halves->second}) {
      const std::vector<Cut> cuts = cutsOf(*half);
      const double share = cuts.empty() ? 1.0 : std::min(cuts.front().cost, 1.0);
      volume_m3 += share * signedVolume(half->hull);
    }
    return volume_m3;
  }

  /// The best cut. When the cheapest cuts hardly differ and gain little, as for a tube, the cuts
  /// that may follow them decide.
  [[nodiscard]] std::optional<CutPlane> bestCut(const Part& part) const {
    const std::vector<Cut> cuts = cutsOf(part);
    if (cuts.empty()) return std::nullopt;
    if (cuts.front().cost < 1.0 - kSmallGain) return cuts.front().plane;
    CutPlane best;
    double lowest_m3 = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min<std::size_t>(cuts.size(), kCutsAhead); ++i) {
      if (cuts[i].cost > cuts.front().cost + kSmallGain) break;
      const double volume_m3 = volumeAfterNextCuts(part, cuts[i].plane);
      if (volume_m3 >= (1.0 - kTie) * lowest_m3) continue;
      lowest_m3 = volume_m3;
      best = cuts[i].plane;
    }
    return std::isfinite(lowest_m3) ? std::optional(best) : std::nullopt;
  }

  /// Cuts the part in two. @return false when no plane divides it
  bool divide(std::size_t index) {
    const auto plane = bestCut(parts_[index]);
    if (!plane) return false;
    auto halves = halvesOf(parts_[index], *plane);
    if (!halves) return false;
    parts_[index] = std::move(halves->first);
    parts_.push_back(std::move(halves->second));
    return true;
  }

  std::optional<Diagnostic> cutSolid() {
    Part whole;
    for (const Vector3i& t : solid_.surface.triangles) {
      const auto& points = solid_.surface.points;
      whole.facets.push_back({{points[t[0]], points[t[1]], points[t[2]]}, false});
    }
    whole.points_m = solid_.surface.points;
    auto part = complete(std::move(whole));
    if (!part)
      return fileFault("", "is flat or degenerate: it encloses no volume", "give it a thickness");
    parts_.push_back(std::move(*part));
    const int most = options_.most_pieces == 1 ? 1 : kPartsForPiece * options_.most_pieces;
    while (std::cmp_less(parts_.size(), most)) {
      reportProgress("cutting, parts", parts_.size());
      std::size_t worst = parts_.size();
      for (std::size_t i = 0; i < parts_.size(); ++i) {
        if (parts_[i].done || parts_[i].excess_m3 <= kVolumeShare * solid_.volume_m3) continue;
        if (worst == parts_.size() || parts_[i].excess_m3 > parts_[worst].excess_m3) worst = i;
      }
      if (worst == parts_.size()) break;
      const bool near = outside(parts_[worst].hull, options_.concavity_m) <= options_.concavity_m;
      if (near || !divide(worst)) parts_[worst].done = true;
    }
    for (Part& p : parts_) pieces_.push_back({std::move(p.hull), 0.0});
    for (Piece& p : pieces_) p.volume_m3 = signedVolume(p.hull);
    return std::nullopt;
  }

  struct Merge {
    std::size_t first, second;
    double added_m3;
    Piece piece;
    double outside_m;  ///< largest distance of the piece's surface outside the solid; negative: not
                       ///< computed yet
  };

  [[nodiscard]] std::optional<Merge> mergeOf(std::size_t i, std::size_t j) const {
    std::vector<Vector3d> points = pieces_[i].hull.points;
    points.insert(points.end(), pieces_[j].hull.points.begin(), pieces_[j].hull.points.end());
    auto hull = convexHull(points);
    if (!hull) return std::nullopt;
    const double volume_m3 = signedVolume(*hull);
    const double added_m3 = volume_m3 - pieces_[i].volume_m3 - pieces_[j].volume_m3;
    return Merge{i, j, added_m3, {std::move(*hull), volume_m3}, -1.0};
  }

  /// Index of the cheapest allowed merge. @param must true when there are too many pieces
  std::optional<std::size_t> nextMerge(std::vector<Merge>& merges, bool must) const {
    std::sort(merges.begin(), merges.end(), [](const Merge& a, const Merge& b) {
      if (a.added_m3 != b.added_m3) return a.added_m3 < b.added_m3;
      return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    });
    for (std::size_t k = 0; k < merges.size(); ++k) {
      if (merges[k].outside_m < 0.0) {
        merges[k].outside_m = outside(merges[k].piece.hull, options_.concavity_m);
      }
      if (merges[k].outside_m <= options_.concavity_m) return k;
    }
    return must && !merges.empty() ? std::optional<std::size_t>(0) : std::nullopt;
  }

  void mergePieces() {
    // Computes the merges of all pairs.
    std::vector<Merge> merges;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (auto merge = mergeOf(j, i)) merges.push_back(std::move(*merge));
      }
    }
    // Applies the cheapest merge until none is allowed, and recomputes the merges of the new piece.
    std::vector<bool> gone(pieces_.size(), false);
    auto left = pieces_.size();
    while (left > 1) {
      reportProgress("merging, pieces", left);
      const bool must = std::cmp_greater(left, options_.most_pieces);
      const auto next = nextMerge(merges, must);
      if (!next) break;
      const auto [first, second] = std::pair(merges[*next].first, merges[*next].second);
      pieces_[first] = std::move(merges[*next].piece);
      gone[second] = true;
      --left;
      std::erase_if(merges, [&, a = first, b = second](const Merge& m) {
        return m.first == a || m.second == a || m.first == b || m.second == b;
      });
      for (std::size_t i = 0; i < pieces_.size(); ++i) {
        if (gone[i] || i == first) continue;
        if (auto merge = mergeOf(std::min(i, first), std::max(i, first))) {
          merges.push_back(std::move(*merge));
        }
      }
    }
    std::vector<Piece> kept;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      if (!gone[i]) kept.push_back(std::move(pieces_[i]));
    }
    pieces_ = std::move(kept);
  }

  void reportProgress(const char* doing, std::size_t count) const {
    if (options_.progress) options_.progress(doing, static_cast<int>(count));
  }

  void measure(ConvexPieces& result) const {
    reportProgress("measuring, pieces", result.pieces.size());
    MeshSurface all;
    for (const MeshSurface& piece : result.pieces) {
      result.beyond_m = std::max(result.beyond_m, outside(piece, result.beyond_m));
      const int first = static_cast<int>(all.points.size());
      all.points.insert(all.points.end(), piece.points.begin(), piece.points.end());
      for (const Vector3i& t : piece.triangles) all.triangles.push_back(t.array() + first);
    }
    result.missing_m = farthestMissing(solid_, all);
    for (std::size_t i = 0; i < result.pieces.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        result.overlap_m3 += overlapOf(result.pieces[i], result.pieces[j], snap_m_);
      }
    }
    result.twice_share = shareInside(solid_, distance_);
  }

  const ClosedSurface& solid_;
  PieceOptions options_;
  SurfaceDistance distance_;
  std::vector<FeaturePlane> features_;
  double snap_m_;
  std::vector<Part> parts_;
  std::vector<Piece> pieces_;
};

}  // namespace

Expected<ConvexPieces> convexPieces(const ClosedSurface& solid, const PieceOptions& options) {
  return Decomposition(solid, options).compute();
}

}  // namespace wholehand
