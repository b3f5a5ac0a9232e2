#include "loop/device/simulated/axis_dynamics.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <bit>
#include <unsupported/Eigen/MatrixFunctions>

namespace wholehand {

Eigen::MatrixXd matrixExponential(const Eigen::MatrixXd& m) {
  return m.exp();
}

AxisDynamics::AxisDynamics(const AxisPlant& plant, double period_s)
    : plant_(plant), grain_s_(period_s / kGrains) {
  const double m = plant.mass;
  for (int level = 0; level <= kLevels; ++level) {
    // Scaled by the step h, the state (q, h q̇) and the input (h² f/m, h³ ḟ/m) are of similar size.
    const double h = grain_s_ * (1 << level);
    Eigen::Matrix4d generator = Eigen::Matrix4d::Zero();
    generator.row(0) << 0.0, 1.0, 0.0, 0.0;
    generator.row(1) << -plant.stiffness * h * h / m, -plant.damping * h / m, 1.0, 0.0;
    generator.row(2) << 0.0, 0.0, 0.0, 1.0;
    const Eigen::Matrix4d e = matrixExponential(generator);
    const double accel = h * h / m;
    transitions_[level].position = {e(0, 0), e(0, 1) * h, e(0, 2) * accel, e(0, 3) * accel * h};
    transitions_[level].velocity = {e(1, 0) / h, e(1, 1), e(1, 2) * h / m, e(1, 3) * accel};
  }
}

void AxisDynamics::place(double position, double velocity) noexcept {
  q_ = std::clamp(position, plant_.lower, plant_.upper);
  qd_ = velocity;
}

double AxisDynamics::effortAt(int grain) const noexcept {
  return effort_.begin + (effort_.end - effort_.begin) * (static_cast<double>(grain) / kGrains);
}

AxisDynamics::State AxisDynamics::after(int level, int grain, double direction) const noexcept {
  const double effort = effortAt(grain) - direction * plant_.coulomb;
  const double slope = (effort_.end - effort_.begin) / (grain_s_ * kGrains);
  const auto& p = transitions_[level].position;
  const auto& v = transitions_[level].velocity;
  return {p[0] * q_ + p[1] * qd_ + p[2] * effort + p[3] * slope,
          v[0] * q_ + v[1] * qd_ + v[2] * effort + v[3] * slope};
}

/// True when the axis can stick. Without dry friction only a stop can hold it.
bool AxisDynamics::canHold() const noexcept {
  return plant_.coulomb > 0.0 || q_ >= plant_.upper || q_ <= plant_.lower;
}

/// True when an axis at rest stays at rest. Dry friction holds in both directions, a stop in one.
bool AxisDynamics::held(int grain) const noexcept {
  const double effort = effortAt(grain) - plant_.stiffness * q_;
  const bool from_rising = effort <= plant_.coulomb || q_ >= plant_.upper;
  const bool from_falling = effort >= -plant_.coulomb || q_ <= plant_.lower;
  return from_rising && from_falling;
}

/// The grain at which an axis at rest starts to move. The holding efforts form an interval and the
/// effort is linear, so it leaves the interval at most once.
int AxisDynamics::stickUntil(int grain) const noexcept {
  if (held(kGrains)) return kGrains;
  int stuck = grain, moving = kGrains;
  while (moving - stuck > 1) {
    const int middle = stuck + (moving - stuck) / 2;
    (held(middle) ? stuck : moving) = middle;
  }
  return moving;
}

/// Moves until zero velocity, a stop or the end of the period; returns the grain reached.
int AxisDynamics::slide(int grain, double direction) noexcept {
  const auto largest = [](int g) { return g == 0 ? kLevels : std::countr_zero(unsigned(g)); };
  int level = largest(grain);
  while (grain < kGrains) {
    const State next = after(level, grain, direction);
    const bool reversed = plant_.coulomb > 0.0 && next.qd * direction <= 0.0;
    const bool beyond = next.q > plant_.upper || next.q < plant_.lower;
    if (!reversed && !beyond) {
      q_ = next.q;
      qd_ = next.qd;
      grain += 1 << level;
      level = std::min(largest(grain), kLevels);
    } else if (level > 0) {
      --level;
    } else {
      if (beyond) q_ = std::clamp(next.q, plant_.lower, plant_.upper);
      qd_ = 0.0;
      return grain + 1;
    }
  }
  return grain;
}

void AxisDynamics::advance(EffortRamp effort) noexcept {
  effort_ = effort;
  int grain = 0;
  for (int events = 0; grain < kGrains && events < kMostEvents; ++events) {
    if (qd_ == 0.0 && canHold() && held(grain)) {
      grain = stickUntil(grain);
      continue;
    }
    const double push = qd_ != 0.0 ? qd_ : effortAt(grain) - plant_.stiffness * q_;
    grain = slide(grain, push < 0.0 ? -1.0 : 1.0);
  }
}

}  // namespace wholehand
