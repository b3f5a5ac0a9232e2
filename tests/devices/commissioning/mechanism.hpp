#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

namespace wholehand::test {

/// One axis of a non-ideal mechanism. SI units; per radian for a rotation.
struct MechanismAxis {
  double mass = 1.0, damping = 0.0;
  double coulomb = 0.0;          ///< dry friction while sliding [N or N·m]
  double breakaway = 0.0;        ///< additional friction at rest (Stribeck) [N or N·m]
  double stribeck_speed = 1e-2;  ///< speed at which the additional friction is 1/e [m/s or rad/s]
  double cogging = 0.0;          ///< amplitude of the cogging [N or N·m]
  double cogging_pitch = 1.0;    ///< [m or rad]
  double play = 0.0;        ///< play between motor and load; the encoder is at the motor [m or rad]
  double load_share = 0.0;  ///< share of the mass that is behind the play
  double gravity = 0.0;     ///< effort that balances gravity [N or N·m]
  double lower = -1.0, upper = 1.0;  ///< end stops [m or rad]
  double step = 0.0;                 ///< step of the encoder [m or rad]; 0: ideal
  double delay_s = 0.0;              ///< any value, also fractions of a period
};

/// Axes with Stribeck friction, cogging, play and coupled inertia, advanced in small steps
/// (symplectic Euler; dry friction as an impulse that stops at rest). It is an independent check of
/// device/simulated, which has none of these.
class Mechanism {
 public:
  Mechanism(std::vector<MechanismAxis> axes, double period_s)
      : axes_(std::move(axes)), states_(axes_.size()), period_s_(period_s) {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      states_[i].at = std::clamp(0.0, axes_[i].lower, axes_[i].upper);
      states_[i].load_at = states_[i].at;
    }
  }

  /// Coupling mass of the neighbours i and i + 1, as a share of the geometric mean of their masses.
  double cross_inertia = 0.0;
  /// External effort on each axis, from a hand or a weight.
  std::vector<double> pushed;

  void place(std::size_t axis, double at) { states_[axis].at = states_[axis].load_at = at; }
  [[nodiscard]] double true_position(std::size_t axis) const { return states_[axis].at; }
  [[nodiscard]] double speed(std::size_t axis) const { return states_[axis].speed; }
  [[nodiscard]] double position(std::size_t axis) const {
    const double step = axes_[axis].step;
    return step > 0.0 ? std::round(states_[axis].at / step) * step : states_[axis].at;
  }
  [[nodiscard]] const MechanismAxis& axis(std::size_t i) const { return axes_[i]; }

  /// Advances one period with these efforts, each after its axis's own delay.
  void advance(const std::vector<double>& effort);

 private:
  struct State {
    double at = 0.0, speed = 0.0, load_at = 0.0, load_speed = 0.0;
    double before = 0.0;        ///< speed at the start of the step
    double acceleration = 0.0;  ///< acceleration in the step before
    std::deque<double> sent;
  };

  [[nodiscard]] double acting(std::size_t i, double into_s) const;
  void accelerate(std::size_t i, double into_s, double h);
  [[nodiscard]] double linked(std::size_t i) const;
  void move(std::size_t i, double h);

  std::vector<MechanismAxis> axes_;
  std::vector<State> states_;
  double period_s_;
};

}  // namespace wholehand::test
