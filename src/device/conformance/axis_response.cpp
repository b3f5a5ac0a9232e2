#include "device/conformance/axis_response.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <utility>

namespace wholehand {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

constexpr double kSpeedOver_s = 0.004;  // each side
constexpr double kCoarse_s = 0.002, kFine_s = 0.00025;
constexpr double kDiffer = 0.3;  // residual with a gain for each way over that with one gain
constexpr double kMotionExplains = 3.0;  // times the step before or after
constexpr double kStepsOfJump = 3.0;
constexpr double kGap_s = 0.004;  // between two samples: this machine was late

// Columns before those of the efforts.
enum : Eigen::Index { kPlace, kSpeed, kOwn, kDamping, kFriction, kBefore };

// The integral of the integral, up to `at_s`, of efforts of one kind that come `delay_s` late.
double pushedTo(const std::vector<PushTrace::Given>& given, double at_s, double delay_s,
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

// Speeds over a few milliseconds around each place; a stall of this machine is not looked across.
Vector speeds(const std::vector<PushTrace::Seen>& seen) {
  const auto near = [&](std::size_t j, std::size_t next, std::size_t k) {
    return std::abs(seen[next].at_s - seen[j].at_s) <= kGap_s &&
           std::abs(seen[next].at_s - seen[k].at_s) <= kSpeedOver_s;
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
  const double least_speed = trace.resolution / (4.0 * kSpeedOver_s) + 1e-12;
  // Mean direction of motion while the speed goes evenly from one to the other.
  const auto soft = [&](double speed) {
    return std::abs(speed) - least_speed * std::log1p(std::abs(speed) / least_speed);
  };
  const auto direction = [&](double from, double to) {
    if (std::abs(to - from) < least_speed) return to / (std::abs(to) + least_speed);
    return (soft(to) - soft(from)) / (to - from);
  };
  // Near 0 where the axis sticks: friction then holds what it has of its own.
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
      // By a cubic: between two samples may lie a stall.
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
  double left = 0.0;  // RMS
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
  // Where the two ways differ, one gain for both would be made up for by the delay.
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
  std::vector<PushTrace::Seen> seen;
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
      late = late || seen[j].at_s - seen[j - 1].at_s > kGap_s;
    }
    if (late) continue;
    const double dt = seen[k].at_s - seen[k - 1].at_s;
    const double moved = std::abs(seen[k].position - seen[k - 1].position);
    const double explained = kMotionExplains * std::max(speed(k - 1), speed(k + 1)) * dt;
    if (moved > explained + kStepsOfJump * trace.resolution) largest = std::max(largest, moved);
  }
  return largest;
}

}  // namespace wholehand
