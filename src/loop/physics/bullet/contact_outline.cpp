#include "loop/physics/bullet/contact_outline.hpp"

#include <algorithm>
#include <cmath>

namespace wholehand::bullet {
namespace {

Corner between(const Corner& a, const Corner& b, double share) {
  return {a.u + share * (b.u - a.u), a.v + share * (b.v - a.v),
          a.height_m + share * (b.height_m - a.height_m)};
}

}  // namespace

// Sutherland, Hodgman 1974.
Outline clip(Outline of, const Outline& within) noexcept {
  constexpr double kEdge_m = 1e-9;  // points this little outside count as inside
  for (int e = 0; e < within.count && of.count > 0; ++e) {
    const Corner& a = within.corners[e];
    const Corner& b = within.corners[(e + 1) % within.count];
    const double length = std::hypot(b.u - a.u, b.v - a.v);
    const auto inside = [&](const Corner& c) { return turnOf(a, b, c) / length + kEdge_m; };
    Outline kept;
    const int edges = of.count > 2 ? of.count : of.count - 1;
    for (int i = 0; i < of.count; ++i) {
      const Corner& from = of.corners[i];
      const double at_from = inside(from);
      if (at_from >= 0.0) kept.add(from);
      if (i >= edges) continue;
      const Corner& to = of.corners[(i + 1) % of.count];
      const double at_to = inside(to);
      if ((at_from < 0.0) != (at_to < 0.0)) {
        kept.add(between(from, to, at_from / (at_from - at_to)));
      }
    }
    of = kept;
  }
  return of;
}

Outline commonOf(const Outline& a, const Outline& b) noexcept {
  Outline out;
  if (a.count == 1 || b.count == 1) {
    out.add(a.count == 1 ? a.corners[0] : b.corners[0]);
    return out;
  }
  const Corner &p = a.corners[0], &q = b.corners[0];
  const double au = a.corners[1].u - p.u, av = a.corners[1].v - p.v;
  const double bu = b.corners[1].u - q.u, bv = b.corners[1].v - q.v;
  const double cross = au * bv - av * bu, a2 = au * au + av * av, b2 = bu * bu + bv * bv;
  if (std::abs(cross) > 0.02 * std::sqrt(a2 * b2)) {
    const double share = ((q.u - p.u) * bv - (q.v - p.v) * bu) / cross;
    const double other = ((q.u - p.u) * av - (q.v - p.v) * au) / cross;
    constexpr double kPast = 1e-6;  // tolerated excess beyond the ends, relative to the edge
    if (share < -kPast || share > 1.0 + kPast || other < -kPast || other > 1.0 + kPast) return out;
    out.add(between(p, a.corners[1], share));
    return out;
  }
  const auto along = [&](const Corner& c) { return ((c.u - p.u) * au + (c.v - p.v) * av) / a2; };
  const double first = along(q), second = along(b.corners[1]);
  const double low = std::max(0.0, std::min(first, second));
  const double high = std::min(1.0, std::max(first, second));
  if (low > high) return out;
  out.add(between(p, a.corners[1], low));
  out.add(between(p, a.corners[1], high));
  return out;
}

}  // namespace wholehand::bullet
