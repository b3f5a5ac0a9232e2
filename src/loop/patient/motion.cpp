#include "loop/patient/motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {
namespace {

constexpr double kGrid_s = 0.01;     // 100 Hz: human motion ends well below 50 Hz
constexpr double kEase_s = 0.2;      // the playing rate rises from 0 to 1 over this time
constexpr double kKneeShare = 0.05;  // share of the allowed range that is compressed at each end

/// Positions of one axis along the recording, on the uniform grid.
using Track = std::vector<double>;

struct Range {
  double lower = 0.0, upper = 0.0;
  [[nodiscard]] double span() const { return upper - lower; }
  [[nodiscard]] double middle() const { return 0.5 * (lower + upper); }
};

Range rangeOf(const Track& track) {
  const auto [low, high] = std::minmax_element(track.begin(), track.end());
  return {*low, *high};
}

Range allowedRange(const DeviceAxis& axis, double margin) {
  const double kept_free = margin * (axis.upper - axis.lower);
  return {axis.lower + kept_free, axis.upper - kept_free};
}

/// Recording times that are played, one per kGrid_s. While easing, the rate follows 3u² - 2u³,
/// whose integral u³ - u⁴/2 covers half the easing time.
std::vector<double> playedInstants(double first_s, double last_s) {
  const double length_s = last_s - first_s;
  const double ease_s = std::min(kEase_s, length_s);
  const double played_s = length_s + ease_s;
  const auto eased = [&](double t_s) {
    const double u = std::min(t_s / ease_s, 1.0);
    return ease_s * (u * u * u - 0.5 * u * u * u * u) + std::max(t_s - ease_s, 0.0);
  };
  const int steps = std::max(2, static_cast<int>(std::ceil(played_s / kGrid_s)));
  std::vector<double> instants;
  instants.reserve(steps + 1);
  for (int i = 0; i <= steps; ++i) {
    const double t_s = played_s * i / steps;
    // Easing out mirrors easing in.
    const double gone_s = 2.0 * t_s < played_s ? eased(t_s) : length_s - eased(played_s - t_s);
    instants.push_back(first_s + gone_s);
  }
  return instants;
}

/// Linear interpolation of one column.
Track resampled(const MotionFile& motion, std::size_t column, const std::vector<double>& at_s) {
  Track track;
  track.reserve(at_s.size() + 4);
  std::size_t next = 1;
  for (const double t_s : at_s) {
    while (next + 1 < motion.time_s.size() && motion.time_s[next] < t_s) ++next;
    const double from_s = motion.time_s[next - 1];
    const double u = std::clamp((t_s - from_s) / (motion.time_s[next] - from_s), 0.0, 1.0);
    const double a = motion.samples[next - 1][column], b = motion.samples[next][column];
    track.push_back(a + (b - a) * u);
  }
  return track;
}

/// Zero-phase taps (1 2 1)/4; both ends stay fixed.
Track smoothed(const Track& raw) {
  Track smooth = raw;
  for (std::size_t i = 1; i + 1 < raw.size(); ++i) {
    smooth[i] = 0.25 * (raw[i - 1] + 2.0 * raw[i] + raw[i + 1]);
  }
  return smooth;
}

/// Compresses a value smoothly into the allowed range: identity except for the last twentieth of
/// the range at each end. The slope is continuous and within [0, 1], so velocities neither jump nor
/// grow.
double bent(double value, Range allowed) {
  const double knee = kKneeShare * allowed.span();
  const double low = allowed.lower + knee, high = allowed.upper - knee;
  if (value > high) return high + knee * std::tanh((value - high) / knee);
  if (value < low) return low - knee * std::tanh((low - value) / knee);
  return value;
}

/// Largest factor that keeps `moved` inside `allowed`, about its own middle or about zero.
double largestScale(Range moved, Range allowed, bool center) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (center) return moved.span() > 0.0 ? allowed.span() / moved.span() : kAny;
  const double up = moved.upper > 0.0 ? allowed.upper / moved.upper : kAny;
  const double down = moved.lower < 0.0 ? allowed.lower / moved.lower : kAny;
  const double scale = std::min(up, down);
  // 0 or less: zero lies outside the workspace, and compression applies instead.
  return scale > 0.0 ? scale : kAny;
}

/// Turns a recorded motion into control points of a spline in the device's coordinates.
class Mapper {
 public:
  Mapper(const MotionFile& motion, const MotionMapping& mapping, const DeviceModel& device)
      : motion_(motion), mapping_(mapping), device_(device) {}

  std::vector<Track> map(const AxisPosition& rest);
  std::vector<std::string> report;

 private:
  void sample(const AxisPosition& rest);
  void reportUnused();
  void placeTranslations();
  void bendIntoRange();
  [[nodiscard]] bool scales(std::size_t i) const {
    return device_.axes[i].kind == AxisKind::kTranslation &&
           device_.axes[i].group == AxisGroup::kBase && moves_[i];
  }

  const MotionFile& motion_;
  const MotionMapping& mapping_;
  const DeviceModel& device_;
  std::vector<Track> tracks_;  // one per device axis
  std::vector<bool> moves_;    // the file has the axis
};

void Mapper::sample(const AxisPosition& rest) {
  const std::vector<double> at_s = playedInstants(motion_.time_s.front(), motion_.time_s.back());
  for (std::size_t i = 0; i < device_.axes.size(); ++i) {
    const DeviceAxis& axis = device_.axes[i];
    const auto found = std::find(motion_.columns.begin(), motion_.columns.end(), axis.name);
    moves_.push_back(found != motion_.columns.end());
    if (moves_.back()) {
      const auto column = found - motion_.columns.begin();
      tracks_.push_back(smoothed(resampled(motion_, column, at_s)));
    } else {
      const int k = static_cast<int>(i);
      const double held = k < rest.size() ? rest[k] : 0.0;
      tracks_.emplace_back(at_s.size(), std::clamp(held, axis.lower, axis.upper));
      report.push_back(fmt::format("{} is not in the file: rests at {:.3g} {}", axis.name,
                                   tracks_.back().front(), axis.positionUnit()));
    }
  }
  report.push_back(
      fmt::format("smoothed without delay (-3 dB at 14 Hz) and eased in and out over {:.2g} s",
                  std::min(kEase_s, motion_.time_s.back() - motion_.time_s.front())));
}

void Mapper::reportUnused() {
  for (const std::string& column : motion_.columns) {
    const bool used = std::any_of(device_.axes.begin(), device_.axes.end(),
                                  [&](const DeviceAxis& axis) { return axis.name == column; });
    if (!used) {
      report.push_back(fmt::format("column {} is ignored: the device {} has no such axis", column,
                                   device_.name));
    }
  }
}

void Mapper::placeTranslations() {
  double scale = 1.0;
  bool any = false;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!scales(i)) continue;
    any = true;
    const Range allowed = allowedRange(device_.axes[i], mapping_.margin);
    scale = std::min(scale, largestScale(rangeOf(tracks_[i]), allowed, mapping_.center));
  }
  if (!any) return;
  if (mapping_.base_scale > 0.0) scale = mapping_.base_scale;
  std::string shifts, extents;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!scales(i)) continue;
    const Range allowed = allowedRange(device_.axes[i], mapping_.margin);
    const double shift =
        mapping_.center ? allowed.middle() - scale * rangeOf(tracks_[i]).middle() : 0.0;
    for (double& value : tracks_[i]) value = scale * value + shift;
    shifts += fmt::format("{}{:+.4f}", shifts.empty() ? "" : ", ", shift);
    extents += fmt::format("{}{} {:.3f} .. {:.3f}", extents.empty() ? "" : ", ",
                           device_.axes[i].name, allowed.lower, allowed.upper);
  }
  report.push_back(fmt::format("translations scaled by {:.3g}, then shifted by ({}) m to fit {} m",
                               scale, shifts, extents));
}

void Mapper::bendIntoRange() {
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (!moves_[i]) continue;
    const DeviceAxis& axis = device_.axes[i];
    const Range allowed = allowedRange(axis, mapping_.margin);
    const Range moved = rangeOf(tracks_[i]);
    const double rounding = 1e-9 * allowed.span();  // tolerance for ends scaled onto the bounds
    if (moved.lower >= allowed.lower - rounding && moved.upper <= allowed.upper + rounding) {
      for (double& v : tracks_[i]) v = std::clamp(v, allowed.lower, allowed.upper);
      continue;
    }
    for (double& value : tracks_[i]) value = bent(value, allowed);
    report.push_back(fmt::format(
        "{} reached {:.3g} .. {:.3g} {}: bent smoothly into {:.3g} .. {:.3g}", axis.name,
        moved.lower, moved.upper, axis.positionUnit(), allowed.lower, allowed.upper));
  }
}

std::vector<Track> Mapper::map(const AxisPosition& rest) {
  sample(rest);
  reportUnused();
  placeTranslations();
  bendIntoRange();
  // Repeats each end three times, so that the spline starts and ends there at rest.
  for (Track& track : tracks_) {
    track.insert(track.begin(), 2, track.front());
    track.insert(track.end(), 2, track.back());
  }
  return std::move(tracks_);
}

/// Largest |velocity| of a uniform cubic B-spline. Its velocity is a quadratic B-spline of the
/// control points' differences, extreme at a knot or inside a span where it turns.
double peakSpeed(const Track& points, double step_s) {
  double peak = 0.0;
  for (std::size_t i = 0; i + 3 < points.size(); ++i) {
    const double d0 = points[i + 1] - points[i];
    const double d1 = points[i + 2] - points[i + 1];
    const double d2 = points[i + 3] - points[i + 2];
    // d(u) = [(1-u)² d0 + (1 + 2u - 2u²) d1 + u² d2] / 2, d'(u) = (d1 - d0) + u (d0 - 2 d1 + d2)
    const double bend = d0 - 2.0 * d1 + d2;
    const double u = bend != 0.0 ? std::clamp((d0 - d1) / bend, 0.0, 1.0) : 0.0;
    const double inner =
        0.5 * ((1.0 - u) * (1.0 - u) * d0 + (1.0 + 2.0 * u - 2.0 * u * u) * d1 + u * u * d2);
    peak = std::max({peak, 0.5 * std::abs(d0 + d1), std::abs(inner), 0.5 * std::abs(d1 + d2)});
  }
  return peak / step_s;
}

/// Factor by which the motion is played more slowly than recorded; reports the axis that demands
/// it.
double slowDown(const std::vector<Track>& tracks, const MotionMapping& mapping,
                const DeviceModel& device, double step_s, std::vector<std::string>& report) {
  double factor = 1.0;
  std::string why;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const DeviceAxis& axis = device.axes[i];
    const double peak = peakSpeed(tracks[i], step_s);
    const double needed = peak / (mapping.speed_share * axis.speed_limit);
    if (needed <= factor) continue;
    factor = needed;
    why = fmt::format("{} reached {:.3g} {}/s, {:.3g} are allowed ({:.3g} of the device's {:.3g})",
                      axis.name, peak, axis.positionUnit(), mapping.speed_share * axis.speed_limit,
                      mapping.speed_share, axis.speed_limit);
  }
  if (factor > 1.0) report.push_back(fmt::format("played {:.3g} times slower: {}", factor, why));
  return factor;
}

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

Intention Intention::fromMotion(const MotionFile& motion, const MotionMapping& mapping,
                                const DeviceModel& device, const AxisPosition& rest,
                                std::vector<std::string>* report) {
  Mapper mapper(motion, mapping, device);
  const std::vector<Track> tracks = mapper.map(rest);
  const std::size_t knots = tracks.front().size() - 2;
  // The two repeated points lengthen the motion by two steps, which belong to the easing.
  const double length_s = motion.time_s.back() - motion.time_s.front();
  const auto instants = static_cast<double>(knots - 3);
  const double recorded_step_s = (length_s + std::min(kEase_s, length_s)) / instants;
  const double factor = slowDown(tracks, mapping, device, recorded_step_s, mapper.report);
  const double step_s = factor * recorded_step_s;

  Intention intention;
  const int axes = device.axisCount();
  for (std::size_t i = 0; i < knots; ++i) {
    Waypoint knot{step_s * static_cast<double>(i), AxisPosition(axes)};
    AxisVelocity velocity(axes);
    for (int k = 0; k < axes; ++k) {
      const Track& c = tracks[k];
      knot.q[k] = (c[i] + 4.0 * c[i + 1] + c[i + 2]) / 6.0;
      velocity[k] = (c[i + 2] - c[i]) / (2.0 * step_s);
    }
    intention.knots_.push_back(knot);
    intention.velocities_.push_back(velocity);
  }
  if (report != nullptr) *report = std::move(mapper.report);
  return intention;
}

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

ScriptedPlayer::ScriptedPlayer(Intention intention, Mover mover)
    : intention_(std::move(intention)), mover_(mover) {}

AxisPosition ScriptedPlayer::start() const {
  return intention_.start();
}

void ScriptedPlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  ++periods_;
  intention_.evaluate(static_cast<double>(periods_) * period_s, q, qd);
}

}  // namespace wholehand
