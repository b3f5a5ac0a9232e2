#include "loop/physics/bullet/contact_patch.hpp"

#include "loop/physics/bullet/bullet_shapes.hpp"
#include "loop/physics/bullet/bullet_types.hpp"
#include "loop/physics/bullet/contact_outline.hpp"
#include "loop/physics/segment_distance.hpp"

#include <BulletCollision/NarrowPhaseCollision/btGjkEpa2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace wholehand::bullet {
namespace {

// Corners within this distance of the farthest one may touch as well.
constexpr double kCorner_m = 5e-4;
constexpr double kFacet_m = 1e-4;  // the same for a mesh, whose facets may be that small
constexpr double kSunk_m = 5e-4;   // at a deeper overlap another face may be the nearest one
// Cosine below which two faces are perpendicular enough to form an edge.
constexpr double kAcross = 0.5;
constexpr double kAlike = 0.98;      // cosine above which two directions count as the same
constexpr double kTie_m = 1e-7;      // gaps of two faces that differ by less count as equal
constexpr double kLevel_m = 1e-9;    // a corner must be deeper by this to become the deepest
constexpr double kEqual = 1e-9;      // relative difference of corners that are equally good
constexpr double kSame_m = 1e-6;     // corners nearer than this count as one
constexpr double kLine_m2 = 1e-9;    // twice the area below which a triangle counts as a line
constexpr double kCoreGap_m = 1e-7;  // points nearer than this give no direction
constexpr double kSure_m = 1e-5;     // tolerance for accepting the direction of nearest points
constexpr double kNearer_m = 1e-5;   // an edge must be nearer by this to be preferred
constexpr double kShort = 0.1;       // shorter edges, relative to the longest one, are skipped
// Smallest distance from all edges, relative to the longest diagonal.
constexpr double kWellWithin = 0.15;
constexpr double kHeldApart_m = 1e-4;  // gap at which overlapping shapes are held apart
constexpr double kSameTurn = 1e-9;     // sine of the angle below which two directions are the same
constexpr int kMostTurns = 6;          // bound of the iterations for the direction of an overlap

/// The direction of a contact and two directions perpendicular to it.
struct Across {
  btVector3 normal, u, v;
  explicit Across(const btVector3& n) : normal(n) { btPlaneSpace1(n, u, v); }
};

/// The corners of a shape that are farthest along `sign` times the normal, as the outline of their
/// hull.
Outline outlineOf(const Convex& of, const Across& across, double sign) {
  const btVector3 d = across.normal * sign * of.at.getBasis();
  const double most = reachAlong(of, d);
  const double within_m = of.form.isMesh() ? kFacet_m : kCorner_m;
  std::array<Corner, kMostCorners> found;
  int count = 0;
  eachCorner(of, d, [&](const btVector3& corner) {
    if (most - corner.dot(d) > within_m || count == kMostCorners) return;
    const btVector3 at = of.at * corner;
    found[count++] = {at.dot(across.u), at.dot(across.v), at.dot(across.normal)};
  });
  // The hull is built by Andrew's monotone chain (1979).
  std::sort(found.begin(), found.begin() + count, [](const Corner& a, const Corner& b) {
    return a.u < b.u || (a.u == b.u && a.v < b.v);
  });
  // Of two corners at the same (u, v), keeps the one that reaches farther.
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    Corner& last = found[std::max(0, kept - 1)];
    const bool same = kept > 0 && std::hypot(found[i].u - last.u, found[i].v - last.v) < kSame_m;
    if (!same) {
      found[kept++] = found[i];
    } else if (sign * found[i].height_m > sign * last.height_m) {
      last.height_m = found[i].height_m;
    }
  }
  count = kept;
  Outline out;
  const auto push = [&](const Corner& corner, int first) {
    while (out.count >= first + 2 &&
           turnOf(out.corners[out.count - 2], out.corners[out.count - 1], corner) <= kLine_m2) {
      --out.count;
    }
    out.add(corner);
  };
  for (int i = 0; i < count; ++i) push(found[i], 0);
  const int back = out.count - 1;
  for (int i = count - 2; i >= 0; --i) push(found[i], back);
  if (out.count > 1) --out.count;  // the last corner repeats the first
  return out;
}

/// Gap between two shapes along a direction from b to a; negative when they overlap.
double gapAlong(const Convex& a, const Convex& b, const btVector3& n) {
  return (a.at.getOrigin() - b.at.getOrigin()).dot(n) - reachAlong(a, -n * a.at.getBasis()) -
         reachAlong(b, n * b.at.getBasis());
}

/// The direction along which two shapes overlap least, among the normals of all faces and the line
/// of the centres.
btVector3 leastOverlap(const Convex& a, const Convex& b) {
  btVector3 best = a.at.getOrigin() - b.at.getOrigin();
  best = best.length2() > 0.0 ? best.normalized() : btVector3(0.0, 0.0, 1.0);
  double most_m = gapAlong(a, b, best);
  const auto try_one = [&](const btVector3& n) {
    const double gap_m = gapAlong(a, b, n);
    if (gap_m <= most_m) return;
    most_m = gap_m;
    best = n;
  };
  const auto try_faces = [&](const Convex& of, double sign) {
    for (const Eigen::Vector3i& t : of.form.triangles) {
      const btVector3& p = of.points[t[0]];
      const btVector3 across = (of.points[t[1]] - p).cross(of.points[t[2]] - p);
      try_one(of.at.getBasis() * (sign * across.normalized()));
    }
    if (of.point_count > 0) return;
    for (int i = 0; i < 3; ++i) {
      for (const double side : {1.0, -1.0}) try_one(side * of.at.getBasis().getColumn(i));
    }
  };
  try_faces(a, -1.0);
  try_faces(b, 1.0);
  return best;
}

struct Nearest {
  ContactPatch::Point point;
  bool found = false;
};

/// Nearest points of two shapes, one of which may be displaced.
class NearestPoints {
 public:
  NearestPoints(const btCollisionObject& a, const btCollisionObject& b)
      : shape_a_(static_cast<const btConvexShape&>(*a.getCollisionShape())),
        shape_b_(static_cast<const btConvexShape&>(*b.getCollisionShape())),
        at_a_(a.getWorldTransform()),
        at_b_(b.getWorldTransform()) {}

  /// Nearest points with a displaced by `away_m`, so that the shapes do not overlap; exact when
  /// both shapes have corners.
  [[nodiscard]] Nearest apart(const btVector3& away_m) const {
    return from(at_a_.getOrigin() + away_m - at_b_.getOrigin(), away_m);
  }
  /// Nearest points, searched for from a guess of their difference, in the frame of a.
  [[nodiscard]] Nearest from(const btVector3& towards,
                             const btVector3& away_m = {0.0, 0.0, 0.0}) const {
    btTransform held = at_a_;
    held.getOrigin() += away_m;
    btGjkEpaSolver2::sResults is;
    if (!btGjkEpaSolver2::Distance(&shape_a_, held, &shape_b_, at_b_, towards, is)) return {};
    if (is.distance < kCoreGap_m) return {};
    // The solver's own normal is in the frame of a, so the normal is computed from the witness
    // points.
    const btVector3 normal = (is.witnesses[0] - is.witnesses[1]) / is.distance;
    const double margin_b = shape_b_.getMargin();
    const double gap_m = is.distance - shape_a_.getMargin() - margin_b;
    return {{is.witnesses[1] + normal * margin_b, normal, gap_m}, true};
  }

 private:
  const btConvexShape &shape_a_, &shape_b_;
  const btTransform &at_a_, &at_b_;
};

/// Nearest points of a capsule or sphere and a convex mesh; not found when the capsule's axis meets
/// the mesh. @param sign 1: from the mesh to the round shape, -1: the reverse
Nearest nearestOfRound(const Convex& round, const Convex& mesh, double sign) {
  const btTransform into = mesh.at.inverseTimes(round.at);
  const double half_m = round.form.coreBox().z();
  const Eigen::Vector3d from = toEigen(into * btVector3(0.0, 0.0, -half_m));
  const Eigen::Vector3d to = toEigen(into * btVector3(0.0, 0.0, half_m));
  const double radius_m = round.form.radius_m;
  const SegmentDistance is =
      hullDistance({mesh.points->m_floats, mesh.point_count, sizeof(btVector3) / sizeof(double)},
                   from, to, radius_m);
  if (is.normal.isZero()) return {};
  const Eigen::Vector3d core_m = from + is.along * (to - from);
  const Eigen::Vector3d on_b =
      core_m - (sign > 0.0 ? is.distance_m + radius_m : radius_m) * is.normal;
  const btVector3 normal = sign * (mesh.at.getBasis() * toBt(is.normal));
  return {{mesh.at * toBt(on_b), normal, is.distance_m}, true};
}

/// Finds the nearest points. For shapes that overlap, one is displaced along a direction, and the
/// nearest points give the next direction, until it no longer changes. The first direction is that
/// of the last step, if there is one.
Nearest nearest(const btCollisionObject& object_a, const btCollisionObject& object_b,
                const Convex& a, const Convex& b, const btVector3* before) {
  const NearestPoints points(object_a, object_b);
  const auto sure = [&](const Nearest& is) {
    return is.found && gapAlong(a, b, is.point.normal) > is.point.gap_m - kSure_m;
  };
  const Nearest as_they_are = points.apart({0.0, 0.0, 0.0});
  // Points that nearly coincide give no reliable direction: the shapes would not be apart along it.
  if (sure(as_they_are)) return as_they_are;
  // For meshes the search may have ended at a simplex that is nearly flat, with points that are not
  // the nearest ones. The search against a capsule's axis does not. For other shapes, it ends
  // elsewhere from another guess.
  const bool a_is_mesh = a.point_count > 0, b_is_mesh = b.point_count > 0;
  const bool with_round = a_is_mesh ? b.form.isRound() : b_is_mesh && a.form.isRound();
  if (with_round) {
    const Nearest exact = a_is_mesh ? nearestOfRound(b, a, -1.0) : nearestOfRound(a, b, 1.0);
    if (sure(exact)) return exact;
  }
  btVector3 along = before != nullptr ? *before : leastOverlap(a, b);
  if (as_they_are.found && !with_round && (a_is_mesh || b_is_mesh)) {
    const btMatrix3x3& basis = object_b.getWorldTransform().getBasis();
    const btVector3 x = basis.getColumn(0), y = basis.getColumn(1), z = basis.getColumn(2);
    for (const btVector3& guess : {along, as_they_are.point.normal, x, y, z, -x, -y, -z}) {
      const Nearest again = points.from(guess * object_a.getWorldTransform().getBasis());
      if (sure(again)) return again;
    }
  }
  double gap_m = gapAlong(a, b, along);
  Nearest out;
  for (int i = 0; i < kMostTurns; ++i) {
    const Nearest held = points.apart((kHeldApart_m - gap_m) * along);
    if (!held.found) break;
    if (!out.found) out = held, out.point.normal = along;
    const btVector3& normal = held.point.normal;
    const double is_m = gapAlong(a, b, normal);
    const bool done = (normal - along).length2() < kSameTurn * kSameTurn;
    if (done || is_m <= gap_m) break;
    along = normal;
    gap_m = is_m;
    out = held;
  }
  out.point.gap_m = gap_m;
  return out;
}

/// Calls `judge` with each face's outward normal (world) and the distance of the other shape from
/// the face's plane. Skips faces into which a point of the other shape lies deep.
template <class Check>
void eachFace(const Convex& of, const Convex& other, const Check& check) {
  const btMatrix3x3& basis = of.at.getBasis();
  const btVector3 within =
      of.at.invXform(other.point_count > 0 ? other.at * other.points[0] : other.at.getOrigin());
  const auto reach = [&](const btVector3& n) {
    return reachAlong(other, -n * other.at.getBasis());
  };
  if (!of.form.isMesh() && !of.form.isRound()) {
    const btVector3 center = of.at.invXform(other.at.getOrigin());
    for (int i = of.form.isCylinder() ? 2 : 0; i < 3; ++i) {
      const double half_m = of.half_m[i];
      for (const double sign : {1.0, -1.0}) {
        if (sign * within[i] - half_m < -kSunk_m) continue;
        const btVector3 n = sign * basis.getColumn(i);
        check(n, sign * center[i] - half_m - reach(n));
      }
    }
  }
  for (const Eigen::Vector3i& t : of.form.triangles) {
    const btVector3& p = of.points[t[0]];
    const btVector3 across = (of.points[t[1]] - p).cross(of.points[t[2]] - p);
    const double off = across.dot(within - p);
    if (off < 0.0 && off * off > kSunk_m * kSunk_m * across.length2()) continue;
    const btVector3 local = across.normalized(), n = basis * local;
    check(n, (other.at.getOrigin() - of.at * p).dot(n) - reach(n));
  }
}

/// The face on whose plane the other body lies, or into which it has sunk slightly.
struct Flush {
  enum class Kind { kNone, kOne, kAcross } kind = Kind::kNone;
  btVector3 normal;  ///< normal of the face for kOne; from b to a
  bool sunk = false;
};

/// Finds the face that lies flush. If two perpendicular faces overlap by no more than kFlush_m, the
/// bodies meet in an edge at most (kAcross): these are flush pieces side by side, or a body that
/// slides from one piece to the next.
Flush findFlush(const Convex& a, const Convex& b, double reach_m) {
  Flush out;
  double best = -kSunk_m;
  // The other body must lie on the plane of one of the two faces, not only near it.
  const auto across = [&](const btVector3& n, double gap) {
    return std::min(gap, best) >= -kFlush_m && std::max(gap, best) <= reach_m &&
           std::min(gap, best) <= kFlush_m && std::abs(n.dot(out.normal)) < kAcross;
  };
  const auto check = [&](const btVector3& n, double gap) {
    if (out.kind == Flush::Kind::kAcross) return;
    if (out.kind == Flush::Kind::kOne && across(n, gap)) {
      out.kind = Flush::Kind::kAcross;
      return;
    }
    if (gap > reach_m || gap < best + kTie_m) return;
    best = gap;
    out = {Flush::Kind::kOne, n, gap < -kFlush_m};
  };
  eachFace(b, a, check);
  eachFace(a, b, [&](const btVector3& n, double gap) { check(-n, gap); });
  return out;
}

/// Centre of pressure of the last step; empty when nothing pressed.
std::optional<Corner> pressedAt(const btPersistentManifold* before, const Across& across) {
  btVector3 moment(0.0, 0.0, 0.0);
  double impulse = 0.0;
  for (int k = 0; before != nullptr && k < before->getNumContacts(); ++k) {
    const btManifoldPoint& point = before->getContactPoint(k);
    moment += point.m_appliedImpulse * point.m_positionWorldOnB;
    impulse += point.m_appliedImpulse;
  }
  if (impulse <= 0.0) return {};
  return Corner{moment.dot(across.u) / impulse, moment.dot(across.v) / impulse, 0.0};
}

using Chosen = std::array<int, ContactPatch::kMost>;

/// Chooses four corners when there are more than a patch holds: the given one, the one farthest
/// from it, and the two farthest to the left and right of the line through both; -1: there is none.
Chosen spreadFrom(int first, const Outline& of) {
  Chosen chosen{first, -1, -1, -1};
  const auto choose = [&](int place, const auto& worth) {
    double best = 1e-15;
    for (int i = 0; i < of.count; ++i) best = std::max(best, worth(of.corners[i]));
    for (int i = 0; i < of.count; ++i) {
      const Corner& at = of.corners[i];
      int& found = chosen[place];
      if (best == 1e-15 || worth(at) < (1.0 - kEqual) * best) continue;
      if (found < 0 || awayFromOrigin(at) < awayFromOrigin(of.corners[found])) found = i;
    }
    return chosen[place];
  };
  const Corner& from = of.corners[first];
  const int last =
      choose(1, [&](const Corner& c) { return std::hypot(c.u - from.u, c.v - from.v); });
  if (last < 0) return chosen;
  const Corner& to = of.corners[last];
  choose(2, [&](const Corner& c) { return turnOf(from, to, c); });
  choose(3, [&](const Corner& c) { return -turnOf(from, to, c); });
  return chosen;
}

/// Distance of a point from the line through two corners; positive on the inner side.
double within(const Corner& a, const Corner& b, const Corner& at) {
  return turnOf(a, b, at) / std::hypot(b.u - a.u, b.v - a.v);
}

/// True when a point is well inside the polygon of the corners of spreadFrom().
bool wellWithin(const Chosen& chosen, const Outline& of, const Corner& at) {
  if (std::min({chosen[1], chosen[2], chosen[3]}) < 0) return false;
  const Corner &a = of.corners[chosen[0]], &b = of.corners[chosen[1]];
  const double least_m = kWellWithin * std::hypot(b.u - a.u, b.v - a.v);
  constexpr std::array kAround{0, 3, 1, 2, 0};
  for (int i = 0; i < 4; ++i) {
    const int from = chosen[kAround[i]], to = chosen[kAround[i + 1]];
    if (within(of.corners[from], of.corners[to], at) < least_m) return false;
  }
  return true;
}

/// Chooses the edge that is nearest to a point, and the two corners that span the largest area with
/// it.
Chosen nearestEdge(const Outline& of, const Corner& at) {
  const auto index = [&](int first, int after) { return (first + after) % of.count; };
  const auto length = [&](int i) {
    const Corner &a = of.corners[i], &b = of.corners[index(i, 1)];
    return std::hypot(b.u - a.u, b.v - a.v);
  };
  double longest_m = 0.0;
  for (int i = 0; i < of.count; ++i) longest_m = std::max(longest_m, length(i));
  const auto away = [&](int a, int b) {
    return awayFromOrigin(of.corners[a]) + awayFromOrigin(of.corners[b]);
  };
  const auto distance = [&](int i) {
    if (length(i) < kShort * longest_m) return 1e30;  // its two corners nearly coincide
    return within(of.corners[i], of.corners[index(i, 1)], at);
  };
  double least_m = 1e30;
  for (int i = 0; i < of.count; ++i) least_m = std::min(least_m, distance(i));
  int first = -1;
  for (int i = 0; i < of.count; ++i) {
    if (distance(i) > least_m + kNearer_m) continue;
    if (first < 0 || away(i, index(i, 1)) < away(first, index(first, 1))) first = i;
  }
  Chosen chosen{};
  double most_m2 = -1.0;
  const Corner &a = of.corners[first], &b = of.corners[index(first, 1)];
  for (int i = 2; i < of.count; ++i) {
    for (int j = i + 1; j < of.count; ++j) {
      const int c = index(first, i), d = index(first, j);
      const double is_m2 = turnOf(a, b, of.corners[c]) + turnOf(a, of.corners[c], of.corners[d]);
      const bool equal = most_m2 >= 0.0 && std::abs(is_m2 - most_m2) <= kLine_m2;
      if (equal ? away(c, d) >= away(chosen[2], chosen[3]) : is_m2 <= most_m2) continue;
      most_m2 = is_m2;
      chosen = {first, index(first, 1), c, d};
    }
  }
  return chosen;
}

/// Sorts points as awayFromOrigin() does.
void sortPoints(ContactPatch& patch) {
  std::sort(patch.points.begin(), patch.points.begin() + patch.count,
            [](const ContactPatch::Point& a, const ContactPatch::Point& b) {
              return a.on_b.length2() < b.on_b.length2();
            });
}

/// Finds the patch of two shapes along a normal. @param before points of the last step; null: none
ContactPatch patchAlong(const Convex& a, const Convex& b, const btVector3& normal, double reach_m,
                        const btPersistentManifold* before) {
  // The common part of the two outlines.
  const Across across(normal);
  const Outline of_a = outlineOf(a, across, -1.0), of_b = outlineOf(b, across, 1.0);
  const bool b_bounds = of_b.count > 2;
  const Outline common = b_bounds         ? clip(of_a, of_b)
                         : of_a.count > 2 ? clip(of_b, of_a)
                                          : commonOf(of_a, of_b);
  const Ground ground_a(of_a), ground_b(of_b);
  // The corners at which the gap is small enough.
  Outline touching;
  std::array<double, 2 * kMostCorners> gaps;
  for (int i = 0; i < common.count; ++i) {
    const Corner& at = common.corners[i];
    const double gap_m = ground_a.height(at) - ground_b.height(at);
    if (gap_m > reach_m) continue;
    gaps[touching.count] = gap_m;
    touching.add(at);
  }
  ContactPatch patch;
  const auto add = [&](int i) {
    const Corner& at = touching.corners[i];
    patch.add({across.u * at.u + across.v * at.v + across.normal * ground_b.height(at),
               across.normal, gaps[i]});
  };
  if (touching.count <= ContactPatch::kMost) {
    for (int i = 0; i < touching.count; ++i) add(i);
    sortPoints(patch);
    return patch;
  }
  const double least_m = *std::min_element(gaps.begin(), gaps.begin() + touching.count);
  int deepest = -1;
  for (int i = 0; i < touching.count; ++i) {
    if (gaps[i] > least_m + kLevel_m) continue;
    if (deepest < 0 ||
        awayFromOrigin(touching.corners[i]) < awayFromOrigin(touching.corners[deepest])) {
      deepest = i;
    }
  }
  // A body tips about an edge of its support, never about a line inside it. If it pressed near an
  // edge, both corners of that edge are kept.
  const std::optional<Corner> pressed = pressedAt(before, across);
  Chosen chosen = spreadFrom(deepest, touching);
  if (pressed && !wellWithin(chosen, touching, *pressed)) chosen = nearestEdge(touching, *pressed);
  for (const int i : chosen) {
    if (i >= 0) add(i);
  }
  sortPoints(patch);
  return patch;
}

}  // namespace

ContactPatch findPatch(const btCollisionObject& object_a, const Shape& form_a,
                       const btCollisionObject& object_b, const Shape& form_b, double reach_m,
                       const btPersistentManifold* before) noexcept {
  const Convex a(object_a, form_a), b(object_b, form_b);
  const Flush flush = findFlush(a, b, reach_m);
  if (flush.kind == Flush::Kind::kAcross) return {};
  if (flush.kind == Flush::Kind::kOne) {
    const ContactPatch patch = patchAlong(a, b, flush.normal, reach_m, before);
    if (patch.count > 0) return patch;
  }
  const bool touched = before != nullptr && before->getNumContacts() > 0;
  const btVector3* along = touched ? &before->getContactPoint(0).m_normalWorldOnB : nullptr;
  const Nearest near = nearest(object_a, object_b, a, b, along);
  if (!near.found || near.point.gap_m > reach_m) return {};
  // The nearest points lie on an edge beside the flush face: only rounding separates the two
  // directions, so there is no contact.
  if (flush.kind == Flush::Kind::kOne && !flush.sunk &&
      near.point.normal.dot(flush.normal) < kAlike) {
    return {};
  }
  ContactPatch patch = patchAlong(a, b, near.point.normal, reach_m, before);
  if (patch.count == 0) patch.add(near.point);
  return patch;
}

}  // namespace wholehand::bullet
