#include "patient/motion.hpp"

#include <algorithm>

namespace wholehand {
namespace {

/// A quantity and its slope over time.
struct Point {
  double value = 0.0, slope = 0.0;
};

/// Minimum jerk from a to b, at rest at both: a + (b - a)(10u³ - 15u⁴ + 6u⁵), 0 <= u <= 1.
Point minimumJerk(double a, double b, double u, double span_s) noexcept {
  const double u2 = u * u;
  const double share = u2 * u * (10.0 - 15.0 * u + 6.0 * u2);
  const double share_per_u = 30.0 * u2 * (1.0 - u) * (1.0 - u);
  return {a + (b - a) * share, (b - a) * share_per_u / span_s};
}

/// Cubic Hermite between two points.
Point hermite(Point a, Point b, double u, double span_s) noexcept {
  const double u2 = u * u, u3 = u2 * u;
  const double value = a.value + (b.value - a.value) * (3.0 * u2 - 2.0 * u3) +
                       span_s * (a.slope * (u3 - 2.0 * u2 + u) + b.slope * (u3 - u2));
  const double slope = (b.value - a.value) * 6.0 * (u - u2) / span_s +
                       a.slope * (3.0 * u2 - 4.0 * u + 1.0) + b.slope * (3.0 * u2 - 2.0 * u);
  return {value, slope};
}

}  // namespace

Intention Intention::throughWaypoints(std::vector<Waypoint> waypoints) {
  Intention intention;
  intention.knots_ = std::move(waypoints);
  intention.minimum_jerk_ = true;
  return intention;
}

void Intention::evaluate(double time_s, AxisPosition& q, AxisVelocity& qd) const noexcept {
  const Waypoint& last = knots_.back();
  const int n = last.q.size();
  qd = AxisVelocity(n);
  if (!(time_s < last.time_s)) {
    q = last.q;
    return;
  }
  if (!(time_s > knots_.front().time_s)) {
    q = knots_.front().q;
    return;
  }
  const auto next = std::upper_bound(knots_.begin(), knots_.end(), time_s,
                                     [](double t, const Waypoint& w) { return t < w.time_s; });
  const auto i = next - knots_.begin();
  const Waypoint& a = knots_[i - 1];
  const Waypoint& b = knots_[i];
  const double span_s = b.time_s - a.time_s;
  const double u = (time_s - a.time_s) / span_s;
  q = AxisPosition(n);
  for (int k = 0; k < n; ++k) {
    const Point p = minimum_jerk_ ? minimumJerk(a.q[k], b.q[k], u, span_s)
                                  : hermite({a.q[k], velocities_[i - 1][k]},
                                            {b.q[k], velocities_[i][k]}, u, span_s);
    q[k] = p.value;
    qd[k] = p.slope;
  }
}

double Intention::duration_s() const noexcept {
  return knots_.back().time_s;
}

AxisPosition Intention::start() const noexcept {
  return knots_.front().q;
}

}  // namespace wholehand
