#include "loop/device/simulated/linked_dynamics.hpp"

#include "loop/device/simulated/axis_dynamics.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace wholehand {
namespace {

constexpr double kRounding = 1e-13;  // rounding error of a sum, relative to its terms
constexpr int kBlockTries = 3;       // attempts without progress before single pivots
constexpr int kMostPivots = 2000;    // bound of the search; a few are usual

/// Solves for λ while the axes at an end of their range stay there; false when G cannot be
/// factorised.
bool solveBetween(const AxisMatrix& g, const AxisColumn& w, const AxisColumn& lower,
                  const AxisColumn& upper, const RangeParts& parts, AxisColumn& lambda) noexcept {
  std::array<Eigen::Index, kMaxAxes> between{};
  Eigen::Index count = 0;
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    const RangePart part = parts[i];
    lambda[i] = part == RangePart::kLow ? lower[i] : part == RangePart::kHigh ? upper[i] : 0.0;
    if (part == RangePart::kBetween) between[count++] = i;
  }
  if (count == 0) return true;
  AxisMatrix block(count, count);
  AxisColumn wanted(count);
  for (Eigen::Index a = 0; a < count; ++a) {
    const Eigen::Index i = between[a];
    wanted[a] = -w[i];
    for (Eigen::Index k = 0; k < w.size(); ++k) wanted[a] -= g(i, k) * lambda[k];
    for (Eigen::Index b = 0; b < count; ++b) {
      block(a, b) = g(i, between[b]);
    }
  }
  const Eigen::LLT<AxisMatrix> cholesky(block);
  if (cholesky.info() != Eigen::Success) return false;
  cholesky.solveInPlace(wanted);
  for (Eigen::Index a = 0; a < count; ++a) lambda[between[a]] = wanted[a];
  return true;
}

/// Range part to which an axis must change; the same part if the axis is consistent.
RangePart better(RangePart part, double lambda, double lower, double upper, double v,
                 double v_size) noexcept {
  if (part == RangePart::kBetween) {
    const double slack = kRounding * std::abs(lambda);
    if (lambda < lower - slack) return RangePart::kLow;
    if (lambda > upper + slack) return RangePart::kHigh;
    return part;
  }
  if (lower == upper) return part;
  const double slack = kRounding * v_size;
  if (part == RangePart::kLow && v < -slack) return RangePart::kBetween;
  if (part == RangePart::kHigh && v > slack) return RangePart::kBetween;
  return part;
}

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kLongestStep_s = 1.0 / 16e3;       // 1/16 ms
constexpr double kStepsPerRadian = 16.0;            // steps per radian of the fastest mode
constexpr int kFewestSteps = 4, kMostSteps = 4096;  // bounds of the number of steps per period

AxisMatrix symmetric(const AxisMatrix& m) {
  return 0.5 * (m + m.transpose());
}

/// Number of steps per period. No step is longer than the limit, or a large part of the fastest
/// mode's cycle.
int stepsOf(const LinkedPlant& plant, double period_s) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
      plant.stiffness, plant.mass, Eigen::EigenvaluesOnly);
  const double fastest_rad_s = std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
  // The small term tolerates rounding: 16.0 must stay 16.
  const double wanted =
      std::max(period_s / kLongestStep_s - 1e-9, kStepsPerRadian * fastest_rad_s * period_s);
  return std::clamp(static_cast<int>(std::ceil(std::min(wanted, 1e6))), kFewestSteps, kMostSteps);
}

std::vector<int> linkedAxes(const PatientLinks& links) {
  std::vector<int> out;
  for (Eigen::Index i = 0; i < links.mass.rows(); ++i) {
    const bool linked = !links.mass.row(i).isZero(0.0) || !links.damping.row(i).isZero(0.0) ||
                        !links.stiffness.row(i).isZero(0.0);
    if (linked) out.push_back(static_cast<int>(i));
  }
  return out;
}

LinkedPlant plantOf(const DeviceModel& device, const PatientConfig& patient,
                    const std::vector<int>& axes) {
  const auto n = static_cast<int>(axes.size());
  LinkedPlant plant{AxisMatrix(n, n), AxisMatrix(n, n), AxisMatrix(n, n),
                    AxisEffort(n),    AxisPosition(n),  AxisPosition(n)};
  for (int i = 0; i < n; ++i) {
    const int at = axes[i];
    for (int k = 0; k < n; ++k) {
      const int other = axes[k];
      plant.mass(i, k) = patient.links.mass(at, other);
      plant.damping(i, k) = patient.links.damping(at, other);
      plant.stiffness(i, k) = patient.links.stiffness(at, other);
    }
    const DeviceAxis& axis = device.axes[at];
    const PatientAxis& person = patient.axes[at];
    plant.mass(i, i) = axis.mass + person.mass;
    plant.damping(i, i) = axis.damping + person.damping;
    plant.stiffness(i, i) = person.stiffness;
    plant.coulomb[i] = axis.coulomb;
    plant.lower[i] = axis.lower;
    plant.upper[i] = axis.upper;
  }
  return plant;
}

}  // namespace

bool solveBox(const AxisMatrix& g, const AxisColumn& w, const AxisColumn& lower,
              const AxisColumn& upper, RangeParts& parts, AxisColumn& lambda) noexcept {
  const Eigen::Index n = w.size();
  lambda.resize(n);
  // Makes the initial guess valid.
  for (Eigen::Index i = 0; i < n; ++i) {
    RangePart& part = parts[i];
    if (lower[i] == upper[i]) part = RangePart::kLow;
    if (part == RangePart::kLow && !std::isfinite(lower[i])) part = RangePart::kBetween;
    if (part == RangePart::kHigh && !std::isfinite(upper[i])) part = RangePart::kBetween;
  }
  Eigen::Index fewest = n + 1;
  int tries = kBlockTries;
  for (int pivot = 0; pivot < kMostPivots; ++pivot) {
    if (!solveBetween(g, w, lower, upper, parts, lambda)) return false;
    // Finds the axes whose part is inconsistent.
    RangeParts next = parts;
    Eigen::Index faulty = 0, last = 0;
    for (Eigen::Index i = 0; i < n; ++i) {
      double v = w[i], size = std::abs(w[i]);
      for (Eigen::Index k = 0; k < n; ++k) {
        v += g(i, k) * lambda[k];
        size += std::abs(g(i, k) * lambda[k]);
      }
      next[i] = better(parts[i], lambda[i], lower[i], upper[i], v, size);
      if (next[i] == parts[i]) continue;
      ++faulty;
      last = i;
    }
    if (faulty == 0) return true;
    // Pivots all of them, or only the last one when block pivots make no progress.
    tries = faulty < fewest ? kBlockTries : tries - 1;
    fewest = std::min(fewest, faulty);
    if (tries >= 0) {
      parts = next;
    } else {  // Murty's rule: pivots only the last axis
      parts[last] = next[last];
    }
  }
  return false;
}

LinkedDynamics::LinkedDynamics(const LinkedPlant& plant, double period_s)
    : plant_(plant), period_s_(period_s), steps_(stepsOf(plant, period_s)) {
  const Eigen::Index n = plant.mass.rows();
  const Eigen::MatrixXd mass = plant.mass;
  const Eigen::MatrixXd inverse = mass.llt().solve(Eigen::MatrixXd::Identity(n, n));
  // Scaled by the step h, the state (q, h q̇) and the input (h² f/m, h³ ḟ/m) are of similar size.
  const double h = period_s / steps_;
  Eigen::MatrixXd generator = Eigen::MatrixXd::Zero(4 * n, 4 * n);
  generator.block(0, n, n, n).setIdentity();
  generator.block(n, 0, n, n) = -h * h * inverse * plant.stiffness;
  generator.block(n, n, n, n) = -h * inverse * plant.damping;
  generator.block(n, 2 * n, n, n).setIdentity();
  generator.block(2 * n, 3 * n, n, n).setIdentity();
  const Eigen::MatrixXd e = matrixExponential(generator);
  const auto part = [&](int row, int column) {
    return Eigen::MatrixXd(e.block(row * n, column * n, n, n));
  };
  to_position_ = {part(0, 0), part(0, 1) * h, symmetric(part(0, 2) * inverse * (h * h)),
                  part(0, 3) * inverse * (h * h * h)};
  to_velocity_ = {part(1, 0) / h, part(1, 1), symmetric(part(1, 2) * inverse * h),
                  part(1, 3) * inverse * (h * h)};
  inverse_mass_ = symmetric(inverse);
  q_ = AxisColumn::Zero(n);
  qd_ = AxisColumn::Zero(n);
}

void LinkedDynamics::place(const AxisPosition& position, const AxisVelocity& velocity) noexcept {
  for (int i = 0; i < position.size(); ++i) {
    q_[i] = std::clamp(position[i], plant_.lower[i], plant_.upper[i]);
    qd_[i] = velocity[i];
  }
}

/// Mean friction over a step of an axis that reverses within it and that friction cannot hold.
/// Friction opposes the old direction until the axis rests and the new one from then on; the speed
/// changes linearly. The mean opposes the net motion, so it still dissipates. @param before, after
/// speeds of opposite sign
double turning(double before, double after, double friction) noexcept {
  const double rests_at = before / (before - after);  // fraction of the step until the axis rests
  return (before > 0.0 ? friction : -friction) * (1.0 - 2.0 * rests_at);
}

/// Adds the effect of dry friction and stops over a step.
void LinkedDynamics::hold(AxisColumn& position, AxisColumn& velocity) noexcept {
  const Eigen::Index n = q_.size();
  AxisColumn lower(n), upper(n), lambda(n);
  RangeParts parts{};
  for (Eigen::Index i = 0; i < n; ++i) {
    const int a = static_cast<int>(i);
    const double friction = plant_.coulomb[a];
    // Friction opposes the motion. An axis that reverses within the step has no friction until it
    // has reversed.
    lower[i] = qd_[i] < 0.0 ? 0.0 : -friction;
    upper[i] = qd_[i] > 0.0 ? 0.0 : friction;
    if (q_[i] >= plant_.upper[a]) lower[i] = -kInfinite;
    if (q_[i] <= plant_.lower[a]) upper[i] = kInfinite;
    parts[i] = qd_[i] > 0.0   ? RangePart::kLow
               : qd_[i] < 0.0 ? RangePart::kHigh
                              : RangePart::kBetween;
  }
  if ((lower.array() == upper.array()).all()) return;
  const AxisColumn free = velocity;
  (void)solveBox(to_velocity_.effort, free, lower, upper, parts, lambda);
  const AxisColumn ends = free + to_velocity_.effort * lambda;
  bool turns = false;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double friction = plant_.coulomb[static_cast<int>(i)];
    const double held = to_velocity_.effort(i, i) * friction;
    const bool let_off = lambda[i] == 0.0 && friction > 0.0;
    if (!let_off || qd_[i] * ends[i] >= 0.0 || std::abs(ends[i]) <= held) continue;
    lower[i] = upper[i] = turning(qd_[i], ends[i], friction);
    turns = true;
  }
  if (turns) (void)solveBox(to_velocity_.effort, free, lower, upper, parts, lambda);
  position.noalias() += to_position_.effort * lambda;
  velocity.noalias() += to_velocity_.effort * lambda;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (parts[i] != RangePart::kBetween) continue;
    velocity[i] = 0.0;
    // A held axis does not move. The effort that is constant over the step would otherwise move it
    // to and fro by f_c h² / 12 m and do work.
    if (qd_[i] == 0.0) position[i] = q_[i];
  }
}

/// Moves axes that are beyond a stop back to it; impulses remove their speed towards the stop.
void LinkedDynamics::meetStops() noexcept {
  const Eigen::Index n = q_.size();
  AxisColumn lower = AxisColumn::Zero(n), upper = AxisColumn::Zero(n), impulse(n);
  RangeParts parts{};
  bool met = false;
  for (Eigen::Index i = 0; i < n; ++i) {
    const int a = static_cast<int>(i);
    if (q_[i] >= plant_.upper[a]) {
      met = met || q_[i] > plant_.upper[a] || qd_[i] > 0.0;
      q_[i] = plant_.upper[a];
      lower[i] = -kInfinite;
    } else if (q_[i] <= plant_.lower[a]) {
      met = met || q_[i] < plant_.lower[a] || qd_[i] < 0.0;
      q_[i] = plant_.lower[a];
      upper[i] = kInfinite;
    } else {
      continue;
    }
    parts[i] = RangePart::kBetween;
  }
  if (!met) return;
  (void)solveBox(inverse_mass_, qd_, lower, upper, parts, impulse);
  qd_ += inverse_mass_ * impulse;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (parts[i] == RangePart::kBetween) qd_[i] = 0.0;
  }
}

void LinkedDynamics::step(const AxisColumn& effort, const AxisColumn& slope) noexcept {
  const auto after = [&](const Transition& t) {
    AxisColumn out = t.position * q_;
    out.noalias() += t.velocity * qd_;
    out.noalias() += t.effort * effort;
    out.noalias() += t.slope * slope;
    return out;
  };
  AxisColumn position = after(to_position_), velocity = after(to_velocity_);
  hold(position, velocity);
  q_ = position;
  qd_ = velocity;
  meetStops();
}

void LinkedDynamics::advance(const AxisEffort& begin, const AxisEffort& end) noexcept {
  const AxisColumn change = end.vec() - begin.vec();
  const AxisColumn slope = change / period_s_;
  for (int k = 0; k < steps_; ++k) {
    const AxisColumn effort = begin.vec() + change * (static_cast<double>(k) / steps_);
    step(effort, slope);
  }
}

LinkedPerson::LinkedPerson(const DeviceModel& device, const PatientConfig& patient, double period_s,
                           int slam_axis) {
  std::vector<int> axes = linkedAxes(patient.links);
  if (axes.empty()) return;
  groups_.push_back({axes, LinkedDynamics(plantOf(device, patient, axes), period_s)});
  if (std::erase(axes, slam_axis) == 0 || axes.empty()) return;
  groups_.push_back({axes, LinkedDynamics(plantOf(device, patient, axes), period_s)});
}

void LinkedPerson::enter(int group, const AxisPosition& q, const AxisVelocity& qd) noexcept {
  now_ = group;
  moved_.fill(false);
  if (group < 0) return;
  Group& g = groups_[group];
  const auto n = static_cast<int>(g.axes.size());
  AxisPosition position(n);
  AxisVelocity velocity(n);
  for (int i = 0; i < n; ++i) {
    const int axis = g.axes[i];
    moved_[axis] = true;
    position[i] = q[axis];
    velocity[i] = qd[axis];
  }
  g.dynamics.place(position, velocity);
}

void LinkedPerson::place(const AxisPosition& q, const AxisVelocity& qd) noexcept {
  enter(groups_.empty() ? -1 : 0, q, qd);
}

void LinkedPerson::hold(const std::array<bool, kMaxAxes>& held, const AxisPosition& q,
                        const AxisVelocity& qd) noexcept {
  const auto all_held = [&](const Group& group) {
    return std::all_of(group.axes.begin(), group.axes.end(), [&](int axis) { return held[axis]; });
  };
  const auto found = std::find_if(groups_.begin(), groups_.end(), all_held);
  const int group = found == groups_.end() ? -1 : static_cast<int>(found - groups_.begin());
  if (group != now_) enter(group, q, qd);
}

void LinkedPerson::advance(const AxisEffort& begin, const AxisEffort& end, AxisPosition& q,
                           AxisVelocity& qd) noexcept {
  if (now_ < 0) return;
  Group& g = groups_[now_];
  const auto n = static_cast<int>(g.axes.size());
  AxisEffort first(n), last(n);
  for (int i = 0; i < n; ++i) {
    first[i] = begin[g.axes[i]];
    last[i] = end[g.axes[i]];
  }
  g.dynamics.advance(first, last);
  for (int i = 0; i < n; ++i) {
    const int axis = g.axes[i];
    q[axis] = g.dynamics.position(i);
    qd[axis] = g.dynamics.velocity(i);
  }
}

}  // namespace wholehand
