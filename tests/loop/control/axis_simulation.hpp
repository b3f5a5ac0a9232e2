#pragma once

#include "certify/stability.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace wholehand::test {

/// Device and person, m ẍ + b ẋ + k x = f, over one period under a constant effort, by the closed
/// form of a damped oscillator. (closedLoopMatrix() uses a series of the matrix exponential.)
class HeldMotion {
 public:
  HeldMotion(double mass, double damping, double stiffness, double period_s) {
    const double a = 0.5 * damping / mass;
    const std::complex<double> w = std::sqrt(std::complex<double>(a * a - stiffness / mass));
    const double decay = std::exp(-a * period_s);
    const double c = decay * std::cosh(w * period_s).real();
    const double s = std::abs(w) * period_s < 1e-9 ? decay * period_s
                                                   : decay * (std::sinh(w * period_s) / w).real();
    // e^{At} = e^{-at} (cosh wt + (A + a) sinh wt / w), A = [0 1; -k/m -b/m].
    xx_ = c + a * s;
    xv_ = s;
    vx_ = -stiffness / mass * s;
    vv_ = c - a * s;
    fv_ = s / mass;
    if (stiffness > 0.0) {
      fx_ = (1.0 - xx_) / stiffness;
    } else if (damping * period_s > 1e-4 * mass) {
      fx_ = (period_s - s) / damping;
    } else {  // series: no cancellation
      fx_ = period_s * period_s / mass * (0.5 - damping * period_s / (6.0 * mass));
    }
  }
  void advance(double& x, double& v, double f) const noexcept {
    const double before = x;
    x = xx_ * x + xv_ * v + fx_ * f;
    v = vx_ * before + vv_ * v + fv_ * f;
  }

 private:
  double xx_, xv_, vx_, vv_, fx_, fv_;
};

/// Simulates one axis over time: filter, coupling and delay of the tick, device and person by
/// HeldMotion, the avatar by symplectic Euler, the held object implicitly. It uses neither a matrix
/// nor an eigenvalue, so it is independent of closedLoopMatrix(). A wall pushes only beyond
/// wall_at.
class AxisSimulation {
 public:
  AxisSimulation(const AxisLoop& loop, ContactCase contact)
      : l(loop),
        contact_(contact),
        held_(loop.mass + loop.person.mass, loop.damping + loop.person.damping,
              loop.person.stiffness, loop.period_s),
        relative_damping_(loop.gamma * loop.k_pm * loop.k_ds_per_s / loop.k_ps_per_s2) {}

  double x = 0.0, v = 0.0, xs = 0.0, vs = 0.0;  ///< device and avatar
  double wall_at = 0.0;
  double most_change = HUGE_VAL;  ///< largest change of the effort in a tick
  bool wall_linear = true;        ///< the wall also pulls, as in the certificate's matrix

  /// Sets the state before the first tick: the filter knows the position but not the speed.
  void start(double position, double velocity) {
    x = before_ = position;
    v = velocity;
    filtered_ = 0.0;
  }

  /// Sets the state of a long flight: the filter knows the speed, and the damping acts.
  void fly(double velocity) {
    start(0.0, velocity);
    filtered_ = velocity;
    sent_ = -l.phi_k_dm * velocity;
    queue_.fill(sent_);
  }

  /// @param tank_effort sent with the rest @param push effort of a person, acts at once
  void tick(double tank_effort = 0.0, double push = 0.0) noexcept {
    const double t = l.period_s;
    filtered_ = (l.filter_tau_s * filtered_ + (x - before_)) / (l.filter_tau_s + t);
    before_ = x;
    const double wanted = l.k_pm * (xs - x) + relative_damping_ * (vs - filtered_) -
                          l.phi_k_dm * filtered_ + wallEffort() + tank_effort;
    const double sent = std::clamp(wanted, sent_ - most_change, sent_ + most_change);
    acceleration_ = l.k_ps_per_s2 * (x - xs) + l.k_ds_per_s * (filtered_ - vs);
    sent_ = felt_ = sent;
    if (l.delay_ticks > 0) {
      felt_ = queue_[at_];
      queue_[at_] = sent;
      at_ = (at_ + 1) % static_cast<std::size_t>(l.delay_ticks);
    }
    held_.advance(x, v, felt_ + push);
    if (contact_ == ContactCase::kRigid) return;
    if (contact_ == ContactCase::kObject) {
      const double mass = 1.0 + l.held_mass;
      vs = (mass * vs + t * (acceleration_ - l.spring_per_s2 * xs)) /
           (mass + t * t * l.spring_per_s2);
    } else {
      vs += t * acceleration_;
    }
    xs += t * vs;
  }

  [[nodiscard]] double filtered() const noexcept { return filtered_; }
  [[nodiscard]] double sent() const noexcept { return sent_; }
  [[nodiscard]] double felt() const noexcept { return felt_; }  ///< acted during the last period
  /// K_pm e + B ė: the drive of the avatar in its last step, as the person feels it.
  [[nodiscard]] double avatarDrive() const noexcept {
    return l.k_pm / l.k_ps_per_s2 * acceleration_;
  }

  /// Energy of everything that moves or is stretched, including person and object, as the person
  /// feels it.
  [[nodiscard]] double energy() const noexcept {
    const double felt_scale = l.k_pm / l.k_ps_per_s2;
    const double e = x - xs, depth = x - wall_at;
    double sum = (l.mass + l.person.mass) * v * v + l.person.stiffness * x * x + l.k_pm * e * e +
                 felt_scale * ((1.0 + l.held_mass) * vs * vs + l.spring_per_s2 * xs * xs);
    if (wall_linear || depth > 0.0) sum += l.wall_stiffness * depth * depth;
    return 0.5 * sum;
  }

  AxisLoop l;

 private:
  [[nodiscard]] double wallEffort() const noexcept {
    const double depth = x - wall_at;
    const double held = l.wall_stiffness * depth + l.wall_damping * filtered_;
    if (wall_linear) return -held;
    return depth > 0.0 ? -std::max(0.0, held) : 0.0;
  }

  ContactCase contact_;
  HeldMotion held_;
  double relative_damping_;
  double before_ = 0.0, filtered_ = 0.0, sent_ = 0.0, felt_ = 0.0, acceleration_ = 0.0;
  std::array<double, 8> queue_{};
  std::size_t at_ = 0;
};

/// True if the stretch between device and avatar swings wider in the last eighth of the time than
/// in the second eighth. A drift of both together does not count.
inline bool swingsWider(AxisSimulation axis, long ticks) {
  axis.start(axis.x == 0.0 ? 1e-3 : axis.x, axis.v);
  const long window = ticks / 8;
  double early = 0.0, late = 0.0;
  for (long k = 0; k < ticks; ++k) {
    axis.tick();
    const double stretch = std::abs(axis.x - axis.xs);
    if (!(stretch < 1e6)) return true;
    if (k >= window && k < 2 * window) early = std::max(early, stretch);
    if (k >= ticks - window) late = std::max(late, stretch);
  }
  return late > early;
}

}  // namespace wholehand::test
