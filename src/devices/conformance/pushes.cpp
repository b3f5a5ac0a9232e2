#include "devices/conformance/pushes.hpp"

#include "loop/realtime/monotonic_clock.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace wholehand {

namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kSlopeOver_s = 0.004;  // to each side
constexpr double kCoarse_s = 0.002, kFine_s = 0.00025;
constexpr double kDiffer = 0.3;          // limit of the residual with a gain per direction over the
                                         // residual with one gain
constexpr double kMotionExplains = 3.0;  // times the step before or after
constexpr double kStepsOfJump = 3.0;
constexpr double kSampleGap_s = 0.004;  // longer gaps between samples mean that this machine was
                                        // late

// Columns of the fit before those of the efforts.
enum : Eigen::Index { kPlace, kSpeed, kOwn, kDamping, kFriction, kBefore };

// Double integral, up to `at_s`, of efforts of one kind that act `delay_s` late.
double pushedTo(const std::vector<PushTrace::EffortChange>& given, double at_s, double delay_s,
                const std::function<double(double share)>& weight) {
  double sum = 0.0;
  const auto since = [at_s](double from_s) {
    const double t = std::max(0.0, at_s - from_s);
    return 0.5 * t * t;
  };
  for (std::size_t i = 0; i < given.size(); ++i) {
    const double w = weight(given[i].share);
    if (w == 0.0) continue;
    sum += w * since(given[i].at_s + delay_s);
    if (i + 1 < given.size()) sum -= w * since(given[i + 1].at_s + delay_s);
  }
  return sum;
}

// Speed at each position, averaged over a few milliseconds. The average does not span a stall of
// this machine.
Vector speeds(const std::vector<PushTrace::Observation>& seen) {
  const auto near = [&](std::size_t j, std::size_t next, std::size_t k) {
    return std::abs(seen[next].at_s - seen[j].at_s) <= kSampleGap_s &&
           std::abs(seen[next].at_s - seen[k].at_s) <= kSlopeOver_s;
  };
  Vector out = Vector::Zero(static_cast<Eigen::Index>(seen.size()));
  for (std::size_t k = 0; k < seen.size(); ++k) {
    std::size_t low = k, high = k;
    while (low > 0 && near(low, low - 1, k)) --low;
    while (high + 1 < seen.size() && near(high, high + 1, k)) ++high;
    if (low == high && k > 0) --low;
    const double dt = seen[high].at_s - seen[low].at_s;
    if (dt > 0.0) {
      out[static_cast<Eigen::Index>(k)] = (seen[high].position - seen[low].position) / dt;
    }
  }
  return out;
}

// All columns that do not depend on the efforts.
Matrix own(const PushTrace& trace) {
  const auto& seen = trace.seen;
  Matrix m = Matrix::Zero(static_cast<Eigen::Index>(seen.size()), kBefore);
  const Vector v = speeds(seen);
  const double least_speed = trace.resolution / (4.0 * kSlopeOver_s) + 1e-12;
  // Mean direction of motion while the speed changes linearly from one value to the other.
  const auto soft = [&](double speed) {
    return std::abs(speed) - least_speed * std::log1p(std::abs(speed) / least_speed);
  };
  const auto direction = [&](double from, double to) {
    if (std::abs(to - from) < least_speed) return to / (std::abs(to) + least_speed);
    return (soft(to) - soft(from)) / (to - from);
  };
  // Close to 0 where the axis sticks, because friction then balances its own effort.
  const auto moving = [&](double speed) {
    return std::abs(speed) / (std::abs(speed) + least_speed);
  };
  double travelled = 0.0, rubbed = 0.0, rubbed_twice = 0.0, pulled = 0.0, pulled_twice = 0.0;
  for (Eigen::Index k = 0; k < m.rows(); ++k) {
    const auto& now = seen[static_cast<std::size_t>(k)];
    const double t = now.at_s - seen.front().at_s;
    if (k > 0) {
      const auto& before = seen[static_cast<std::size_t>(k - 1)];
      const double dt = now.at_s - before.at_s;
      const double sign = direction(v[k - 1], v[k]);
      // Integrated with a cubic, because there may be a stall between two samples.
      travelled += 0.5 * dt * (now.position + before.position - 2.0 * seen.front().position) +
                   dt * dt / 12.0 * (v[k - 1] - v[k]);
      rubbed_twice += dt * (rubbed + 0.5 * dt * sign);
      rubbed += dt * sign;
      const double moves = 0.5 * (moving(v[k - 1]) + moving(v[k]));
      pulled_twice += dt * (pulled + 0.5 * dt * moves);
      pulled += dt * moves;
    }
    m(k, kPlace) = 1.0;
    m(k, kSpeed) = t;
    m(k, kOwn) = pulled_twice;
    m(k, kDamping) = -travelled;
    m(k, kFriction) = -rubbed_twice;
  }
  return m;
}

struct Fit {
  Vector found;
  double left = 0.0;  // RMS of the residual
};

Fit fit(const PushTrace& trace, const Matrix& own_columns, double delay_s, int kinds,
        const std::function<int(double)>& kind) {
  const Eigen::Index n = own_columns.rows();
  Matrix m(n, kBefore + kinds);
  m.leftCols(kBefore) = own_columns;
  Vector y(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& seen = trace.seen[static_cast<std::size_t>(k)];
    y[k] = seen.position;
    for (int j = 0; j < kinds; ++j) {
      m(k, kBefore + j) = pushedTo(trace.given, seen.at_s, delay_s,
                                   [&](double share) { return kind(share) == j ? share : 0.0; });
    }
  }
  Vector scale(m.cols());
  for (Eigen::Index c = 0; c < m.cols(); ++c) {
    scale[c] = std::max(m.col(c).norm(), 1e-300);
    m.col(c) /= scale[c];
  }
  Fit out;
  Eigen::ColPivHouseholderQR<Matrix> solver(m);
  solver.setThreshold(1e-9);
  out.found = solver.solve(y);
  out.left = (y - m * out.found).norm() / std::sqrt(static_cast<double>(n));
  out.found.array() /= scale.array();
  return out;
}

int anyPush(double share) {
  return share != 0.0 ? 0 : -1;
}

int eachWay(double share) {
  return share > 0.0 ? 0 : share < 0.0 ? 1 : -1;
}

}  // namespace

AxisResponse findResponse(const PushTrace& trace, double longest_delay_s) {
  AxisResponse out;
  if (trace.seen.size() < 3 * kBefore) return out;
  const Matrix columns = own(trace);
  const auto best_delay = [&](int kinds, int (*kind)(double)) {
    double best_s = 0.0, least = HUGE_VAL;
    const auto scan = [&](double from_s, double until_s, double step_s) {
      for (double d = std::max(0.0, from_s); d <= until_s; d += step_s) {
        const double left = fit(trace, columns, d, kinds, kind).left;
        if (left < least) least = left, best_s = d;
      }
    };
    scan(0.0, longest_delay_s, kCoarse_s);
    scan(best_s - kCoarse_s, std::min(longest_delay_s, best_s + kCoarse_s), kFine_s);
    return std::pair(best_s, least);
  };
  const auto [one_s, one_left] = best_delay(1, anyPush);
  const auto [each_s, each_left] = best_delay(2, eachWay);
  // If the two directions differ, a fit with one gain would compensate the difference by a wrong
  // delay.
  out.delay_s = each_left < kDiffer * one_left ? each_s : one_s;
  const Fit best = fit(trace, columns, out.delay_s, 1, anyPush);
  const Fit ways = fit(trace, columns, out.delay_s, 2, eachWay);
  double mean = 0.0, moved = 0.0;
  const auto n = static_cast<double>(trace.seen.size());
  for (const auto& seen : trace.seen) mean += seen.position / n;
  for (const auto& seen : trace.seen) moved += (seen.position - mean) * (seen.position - mean) / n;
  out.gain = best.found[kBefore];
  const double gain = out.gain != 0.0 ? out.gain : 1e-300;
  out.damping = ways.found[kDamping];
  out.friction = ways.found[kFriction] / gain;
  out.own = ways.found[kOwn] / gain;
  out.unexplained = moved > 0.0 ? best.left / std::sqrt(moved) : 0.0;
  return out;
}

std::vector<double> gainsByKind(const PushTrace& trace, double delay_s, int kinds,
                                const std::function<int(double share)>& kind) {
  const Fit found = fit(trace, own(trace), delay_s, kinds, kind);
  return {found.found.data() + kBefore, found.found.data() + kBefore + kinds};
}

Parabola parabolaThrough(const PushTrace& trace, double from_s, double until_s) {
  std::vector<PushTrace::Observation> seen;
  for (const auto& place : trace.seen) {
    if (place.at_s >= from_s && place.at_s <= until_s) seen.push_back(place);
  }
  Parabola out;
  out.places = seen.size();
  if (seen.size() < 4) return out;
  const double middle_s = 0.5 * (seen.front().at_s + seen.back().at_s);
  Matrix m(static_cast<Eigen::Index>(seen.size()), 3);
  Vector y(m.rows());
  for (Eigen::Index k = 0; k < m.rows(); ++k) {
    const auto& place = seen[static_cast<std::size_t>(k)];
    const double t = place.at_s - middle_s;
    m.row(k) << 1.0, t, 0.5 * t * t;
    y[k] = place.position - seen.front().position;
  }
  const Vector found = m.colPivHouseholderQr().solve(y);
  out.speed = found[1];
  out.acceleration = found[2];
  return out;
}

double largestJump(const PushTrace& trace) {
  const auto& seen = trace.seen;
  const auto speed = [&](std::size_t k) {
    const double dt = seen[k].at_s - seen[k - 1].at_s;
    return dt > 0.0 ? std::abs(seen[k].position - seen[k - 1].position) / dt : 0.0;
  };
  double largest = 0.0;
  for (std::size_t k = 2; k + 1 < seen.size(); ++k) {
    bool late = false;
    for (std::size_t j = k - 1; j <= k + 1; ++j) {
      late = late || seen[j].at_s - seen[j - 1].at_s > kSampleGap_s;
    }
    if (late) continue;
    const double dt = seen[k].at_s - seen[k - 1].at_s;
    const double moved = std::abs(seen[k].position - seen[k - 1].position);
    const double explained = kMotionExplains * std::max(speed(k - 1), speed(k + 1)) * dt;
    if (moved > explained + kStepsOfJump * trace.resolution) largest = std::max(largest, moved);
  }
  return largest;
}

namespace {

constexpr double kSpeedOver_s = 0.005;

constexpr double kMoved = 0.01, kMovedSteps = 30.0;  // share of the travel; steps of the encoder
constexpr double kShortest_s = 0.008, kLongest_s = 0.15;
constexpr double kBeyond = 0.02;  // share of the travel
constexpr double kFar = 0.2;      // share of the travel, from the beginning of a course
constexpr double kOthers = 4.0;   // motion of another axis by this many times kMoved ends a push
constexpr double kLongestDelay_s = 0.08;
constexpr double kWholePush = 0.75;  // larger shares count as whole pushes
constexpr double kBring_hz = 2.5, kBring_s = 0.8;
constexpr double kNear = 0.05, kSlow = 0.002, kSlowOver_s = 0.05;  // shares of the travel
constexpr double kRests = 5e-4, kRestSteps = 3.0, kRestOver_s = 0.05, kRest_s = 1.0;
constexpr double kPush_s = 0.04, kWindow_s = 0.06;
constexpr double kRoom = 0.3;    // share of the travel that an unending push may use
constexpr double kEnds = 0.005;  // share of the travel
constexpr double kGap_s = 0.01;  // a longer gap between two samples is a stall of this machine
constexpr int kAttempts = 5;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double travel(const wh_axis& axis) {
  return axis.upper - axis.lower;
}

double middle(const wh_axis& axis) {
  return 0.5 * (axis.lower + axis.upper);
}

double movedBy(const wh_axis& axis) {
  return std::max(kMoved * travel(axis), kMovedSteps * axis.resolution);
}

bool takesEffort(const wh_axis& axis) {
  return axis.effort_meaning == WH_EFFORT;
}

Shares only(std::size_t axis, double share) {
  Shares out{};
  out.at(axis) = share;
  return out;
}

bool within(const DriverBench& bench, const PushSequence& sequence) {
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    const wh_axis& axis = bench.axes()[a];
    const double out =
        std::max(sequence.position(a) - axis.upper, axis.lower - sequence.position(a));
    if (out > kBeyond * travel(axis)) return false;
  }
  return true;
}

// Position of every axis at the beginning of a course.
class Start {
 public:
  Start(const DriverBench& bench, const PushSequence& sequence)
      : bench_(bench), sequence_(sequence) {
    for (std::size_t j = 0; j < bench.axes().size(); ++j) places_.push_back(sequence.position(j));
  }
  [[nodiscard]] bool moved(std::size_t a, double times) const {
    return gone(a) >= times * movedBy(bench_.axes()[a]);
  }
  // True when an axis runs away; it is then no longer pushed, before it reaches its end.
  [[nodiscard]] bool far() const {
    for (std::size_t j = 0; j < places_.size(); ++j) {
      if (gone(j) > kFar * travel(bench_.axes()[j])) return true;
    }
    return false;
  }

 private:
  [[nodiscard]] double gone(std::size_t a) const {
    return std::abs(sequence_.position(a) - places_[a]);
  }
  const DriverBench& bench_;
  const PushSequence& sequence_;
  std::vector<double> places_;
};

// Pushes until the axis has moved, or another one has moved far more. Returns the duration [s]; 0
// when nothing moved.
double pushUntilMoved(PushSequence& sequence, const Start& start, std::size_t axes, std::size_t a,
                      double share) {
  const double began_s = sequence.now_s();
  bool moved = false;
  sequence.push(only(a, share), kLongest_s, [&] {
    moved = start.moved(a, 1.0);
    for (std::size_t j = 0; j < axes; ++j) moved = moved || start.moved(j, kOthers);
    return (moved && sequence.now_s() - began_s >= kShortest_s) || start.far();
  });
  return moved ? sequence.now_s() - began_s : 0.0;
}

// Pushes to and fro with whole and half pushes, each time back to the beginning; then slowly, and
// back.
void pushToAndFro(PushSequence& sequence, const Start& start, std::size_t a, double share,
                  double push_s) {
  const double half = 0.5 * share, half_s = 1.4 * push_s;
  const std::pair<double, double> pushes[] = {
      {-share, push_s}, {-share, push_s},     {share, push_s},
      {half, half_s},   {-half, half_s},      {-half, half_s},
      {half, half_s},   {0.0, 0.02},          {0.1 * share, 3.0 * push_s},
      {0.0, 0.2},       {-share, kShortest_s}};
  for (const auto& [asked, seconds] : pushes) {
    if (!start.far()) sequence.push(only(a, asked), seconds, [&] { return start.far(); });
  }
  sequence.push({}, 0.03);
}

// Correlates the measured effort with the commanded one at each lag, and keeps the best.
void checkMeasured(const DriverBench& bench, const PushSequence& sequence, std::size_t a,
                   PushedAxis& out) {
  const double limit = bench.axes()[a].effort_limit;
  double best = 0.0;
  out.measured = kNan;
  for (double lag_s = 0.0; lag_s <= kLongestDelay_s; lag_s += 0.001) {
    double both = 0.0, asked = 0.0, reported = 0.0;
    for (const SampleRead& s : sequence.samples()) {
      const double e = s.sample.effort[a],
                   u = limit * sequence.shareAt(a, sequence.timeOf(s) - lag_s);
      if (!std::isfinite(e)) continue;
      both += e * u;
      asked += u * u;
      reported += e * e;
    }
    if (asked == 0.0) continue;
    if (std::isnan(out.measured)) out.measured = both / asked;
    const double alike = reported > 0.0 ? std::abs(both) / std::sqrt(asked * reported) : 0.0;
    if (alike <= best) continue;
    best = alike;
    out.measured = both / asked;
    out.measured_late_s = lag_s;
  }
  double asked = 0.0;
  for (const SampleRead& s : sequence.samples())
    asked += std::pow(sequence.shareAt(a, sequence.timeOf(s)), 2);
  for (std::size_t j = 0; j < bench.axes().size(); ++j) {
    double reported = 0.0;
    for (const SampleRead& s : sequence.samples()) {
      const double e = s.sample.effort[j] / bench.axes()[j].effort_limit;
      if (std::isfinite(e)) reported += e * e;
    }
    out.measured_elsewhere.push_back(asked > 0.0 && j != a ? std::sqrt(reported / asked) : 0.0);
  }
}

PushedAxis pushAxis(DriverBench& bench, std::size_t a) {
  PushedAxis out;
  const wh_axis& axis = bench.axes()[a];
  out.asked = takesEffort(axis);
  if (!out.asked) return out;
  PushSequence sequence(bench);
  sequence.push({}, 0.01);
  const Start start(bench, sequence);
  const std::size_t axes = bench.axes().size();
  double share = sequence.position(a) <= middle(axis) ? kEffortShare : -kEffortShare;
  double push_s = pushUntilMoved(sequence, start, axes, a, share);
  if (push_s == 0.0) {
    sequence.push({}, 0.02);
    push_s = pushUntilMoved(sequence, start, axes, a, share = -share);
  }
  out.tried_s = push_s > 0.0 ? push_s : kLongest_s;
  if (push_s > 0.0) pushToAndFro(sequence, start, a, share, push_s);
  out.late = sequence.late();
  out.within = within(bench, sequence);
  bench.disableAtNeutral();  // the following computation takes longer than the drive's watchdog
                             // allows
  const PushTrace trace = sequence.trace(a, a);
  const auto [least, most] =
      std::minmax_element(trace.seen.begin(), trace.seen.end(),
                          [](const auto& p, const auto& q) { return p.position < q.position; });
  out.moved =
      push_s > 0.0 && !trace.seen.empty() && most->position - least->position >= movedBy(axis);
  bench.alive();  // the computation takes seconds on a busy machine
  checkMeasured(bench, sequence, a, out);
  bench.alive();
  out.response = findResponse(trace, kLongestDelay_s);
  out.jump = largestJump(trace);
  const auto gains = gainsByKind(trace, out.response.delay_s, 5, [&](double asked) {
    if (std::abs(asked) < 0.4 * kEffortShare) return 4;  // the slow push
    return (std::abs(asked) > kWholePush * kEffortShare ? 0 : 2) + (asked > 0.0 ? 0 : 1);
  });
  out.back = gains[1] / gains[0];
  out.half_forth = gains[2] / gains[0];
  out.half_back = gains[3] / gains[0];
  for (std::size_t j = 0; j < bench.axes().size(); ++j) {
    bench.alive();
    const PushTrace other = sequence.trace(a, j);
    // Uses the delay of the pushed axis; if that axis does not move, the delay of the other one.
    const double delay_s =
        out.moved ? out.response.delay_s : findResponse(other, kLongestDelay_s).delay_s;
    out.along.push_back(gainsByKind(other, delay_s, 1, [](double) { return 0; }).front());
  }
  return out;
}

// Share at which the axis stays within its room, even if the push never ends.
double roomyShare(const wh_axis& axis, const AxisResponse& response, double until_s) {
  const double room = kRoom * travel(axis) / (0.5 * std::abs(response.gain) * until_s * until_s);
  return std::min(kEffortShare, room);
}

}  // namespace

PushSequence::PushSequence(DriverBench& bench) : bench_(bench), from_ns_(monotonicNow_ns()) {
  askNothing();
}

double PushSequence::now_s() const {
  return static_cast<double>(monotonicNow_ns() - from_ns_) * 1e-9;
}

double PushSequence::timeOf(const SampleRead& sampled) const {
  return static_cast<double>(sampled.sample.monotonic_ns - from_ns_) * 1e-9;
}

void PushSequence::askNothing() {
  given_.emplace_back(now_s(), Shares{});
}

void PushSequence::push(const Shares& shares, double seconds, const std::function<bool()>& done) {
  everyMillisecond(seconds, [&] {
    const double now = now_s();
    if (written_s_ >= 0.0) longest_write_gap_s_ = std::max(longest_write_gap_s_, now - written_s_);
    written_s_ = now;
    const bool taken = bench_.writeShares(shares) >= 0;
    if (taken && shares != given_.back().second) given_.emplace_back(now_s(), shares);
    take();
    return !done || !done();
  });
}

void PushSequence::watch(double seconds, const std::function<bool()>& done) {
  everyMillisecond(seconds, [&] {
    take();
    return !done || !done();
  });
}

void PushSequence::take() {
  const SampleRead now = bench_.read();
  const bool newer = samples_.empty() || now.sample.sequence != samples_.back().sample.sequence;
  if (now.result >= 0 && newer) samples_.push_back(now);
}

bool PushSequence::late() const {
  return longest_write_gap_s_ > 0.5 * bench_.patience_s() || longestGap_s(0.0) > kGap_s;
}

PushTrace PushSequence::trace(std::size_t pushed, std::size_t seen) const {
  PushTrace out;
  out.resolution = bench_.axes()[seen].resolution;
  for (const auto& [at_s, shares] : given_) out.given.push_back({at_s, shares.at(pushed)});
  for (const SampleRead& s : samples_) {
    const bool valid = (s.sample.valid >> seen & 1U) != 0;
    const double at_s = timeOf(s);
    const bool later = out.seen.empty() || at_s > out.seen.back().at_s;
    if (valid && later && std::isfinite(s.sample.position[seen])) {
      out.seen.push_back({at_s, s.sample.position[seen]});
    }
  }
  return out;
}

double PushSequence::shareAt(std::size_t axis, double at_s) const {
  double share = 0.0;
  for (const auto& [from_s, shares] : given_) {
    if (from_s <= at_s) share = shares.at(axis);
  }
  return share;
}

double PushSequence::position(std::size_t axis) const {
  return samples_.empty() ? 0.0 : samples_.back().sample.position[axis];
}

double PushSequence::speed(std::size_t axis) const {
  if (samples_.empty()) return 0.0;
  const double now_s = timeOf(samples_.back());
  for (auto s = samples_.rbegin(); s != samples_.rend(); ++s) {
    const double dt = now_s - timeOf(*s);
    if (dt >= kSpeedOver_s) return (position(axis) - s->sample.position[axis]) / dt;
  }
  return 0.0;
}

double PushSequence::longestGap_s(double from_s) const {
  double longest = 0.0, last_s = from_s;
  for (const SampleRead& s : samples_) {
    const double at_s = timeOf(s);
    if (at_s < from_s) continue;
    longest = std::max(longest, at_s - last_s);
    last_s = at_s;
  }
  return std::max(longest, now_s() - last_s);
}

std::vector<PushedAxis> pushEveryAxis(DriverBench& bench) {
  std::vector<PushedAxis> out;
  for (std::size_t a = 0; a < bench.axes().size(); ++a) {
    PushedAxis axis;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      bench.alive();
      if (attempt > 0 && !bench.reach(DriverStage::kEnabled).empty()) break;
      axis = pushAxis(bench, a);
      if (!axis.late) break;
    }
    out.push_back(axis);
    if (!bench.reach(DriverStage::kEnabled).empty()) break;
    bringToMiddle(bench, out);
  }
  while (out.size() < bench.axes().size()) {  // the device can no longer be enabled
    PushedAxis left_out;
    left_out.asked = left_out.late = true;
    left_out.along.assign(bench.axes().size(), 0.0);
    out.push_back(left_out);
  }
  // Divides by the own gain of each axis; all of them are known only now.
  for (PushedAxis& axis : out) {
    for (std::size_t j = 0; j < axis.along.size(); ++j) {
      const double own = out[j].moved ? std::abs(out[j].response.gain) : 0.0;
      const double least = movedBy(bench.axes()[j]);
      const double seen = std::abs(axis.along[j]);
      // An axis that does not follow its own effort is compared with the smallest motion that
      // counts.
      const double per = 2.0 * least / (kEffortShare * axis.tried_s * axis.tried_s + 1e-300);
      axis.along[j] = seen / (own > 0.0 ? own : per);
    }
  }
  return out;
}

void bringToMiddle(DriverBench& bench, const std::vector<PushedAxis>& axes) {
  const double w = 2.0 * std::numbers::pi * kBring_hz;
  PushSequence sequence(bench);
  sequence.push({}, 0.008);
  const double began_s = sequence.now_s();
  while (sequence.now_s() - began_s < kBring_s) {
    Shares shares{};
    bool there = true;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      const AxisResponse& r = axes[a].response;
      if (!axes[a].moved || !(r.gain > 0.0)) continue;
      const double off = sequence.position(a) - middle(bench.axes()[a]), v = sequence.speed(a);
      const double range = travel(bench.axes()[a]);
      there = there && std::abs(off) < kNear * range && std::abs(v) * kSlowOver_s < kSlow * range;
      shares.at(a) =
          std::clamp((-w * w * off - 2.0 * w * v) / r.gain - r.own, -kEffortShare, kEffortShare);
    }
    if (there) break;
    sequence.push(shares, 0.001);
  }
  (void)bench.writeNeutral();
}

int awaitRest(DriverBench& bench) {
  PushSequence sequence(bench);
  int moving = -1;
  for (double waited_s = 0.0; waited_s < kRest_s; waited_s += kRestOver_s) {
    sequence.watch(0.002);
    const std::size_t from = sequence.samples().size();
    sequence.watch(kRestOver_s);
    if (from == 0 || sequence.samples().size() <= from) continue;
    moving = -1;
    const wh_sample& before = sequence.samples()[from - 1].sample;
    for (std::size_t a = 0; a < bench.axes().size(); ++a) {
      const wh_axis& axis = bench.axes()[a];
      const double most = kRests * travel(axis) + kRestSteps * axis.resolution;
      if (std::abs(sequence.position(a) - before.position[a]) > most) moving = static_cast<int>(a);
    }
    if (moving < 0) break;
  }
  return moving;
}

LeftOver leftAfter(DriverBench& bench, const std::vector<PushedAxis>& axes, double allow_s,
                   bool writes, const std::function<std::string(PushSequence&)>& stop) {
  LeftOver out;
  out.share.assign(axes.size(), 0.0);
  out.own = out.pushed = out.share;
  int attempts = 0;
  for (int way = 0; way < 2;) {
    const double sign = way == 0 ? 1.0 : -1.0;
    bench.alive();
    if (way > 0 || attempts > 0) out.not_judged = bench.reach(DriverStage::kEnabled);
    if (!out.not_judged.empty()) return out;
    bringToMiddle(bench, axes);
    PushSequence sequence(bench);
    Shares shares{};
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!axes[a].moved) continue;
      out.pushed[a] = roomyShare(bench.axes()[a], axes[a].response, kPush_s + allow_s + kWindow_s);
      shares.at(a) = sign * out.pushed[a];
    }
    sequence.push(shares, kPush_s);
    const bool late = sequence.late();
    if (out.not_judged = stop(sequence); !out.not_judged.empty()) return out;
    sequence.askNothing();
    const auto go_on = [&](double seconds) {
      if (writes) sequence.push({}, seconds);
      if (!writes) sequence.watch(seconds);
    };
    go_on(allow_s);
    const double from_s = sequence.now_s();
    go_on(kWindow_s);
    if (late || sequence.longestGap_s(from_s) > kGap_s) {
      if (++attempts < kAttempts) continue;
      out.not_judged = "this machine stood still meanwhile";
      return out;
    }
    attempts = 0;
    ++way;
    for (std::size_t a = 0; a < axes.size(); ++a) {
      if (!axes[a].moved) continue;
      const wh_axis& axis = bench.axes()[a];
      const Parabola p = parabolaThrough(sequence.trace(a, a), from_s, sequence.now_s());
      const double damping = std::max(0.0, axes[a].response.damping);
      double left = (p.acceleration + damping * p.speed) / axes[a].response.gain;
      const double end =
          sign > 0.0 ? axis.upper - sequence.position(a) : sequence.position(a) - axis.lower;
      if (end < kEnds * travel(axis)) left = sign * out.pushed[a];  // it moved on to its end
      out.share[a] += 0.5 * sign * left / out.pushed[a];
      out.own[a] += 0.5 * left;
    }
  }
  return out;
}

}  // namespace wholehand
