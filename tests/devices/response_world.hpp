#pragma once

#include "devices/plugin/response_judge.hpp"
#include "loop/patient/active_patient.hpp"
#include "support/seed.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>

namespace wholehand::test {

/// A device and the gains with which it is rendered: those of config/.
struct RenderedAxis {
  double mass, damping, limit, step;  ///< [kg], [N·s/m], [N], [m]
  double k, b;                        ///< of the coupling with the hand in the scene
};
inline constexpr RenderedAxis kDesktop = {0.25, 3.0, 8.0, 2e-5, 400.0, 4.5};
inline constexpr RenderedAxis kLambda = {0.8, 6.0, 20.0, 1e-5, 1000.0, 10.5};

/// A person's limb on the axis: it moves with the axis, towards `aim`.
struct Limb {
  double mass = 0.0, damping = 0.0, stiffness = 0.0;
  double tremor = 0.0, tremor_hz = 5.0;  ///< [N]
  bool moves = false;                    ///< to and fro at random
};

/// One axis in small steps (semi-implicit Euler, dry friction as an impulse), its drive, a limb, a
/// therapist, and a hand in a scene of two walls, coupled as in rendering. What the drive does with
/// an effort is the test's. Nothing here is shared with the code under test.
class ResponseWorld {
 public:
  static constexpr double kPeriod_s = 1e-3;
  static constexpr int kSteps = 8;

  ResponseWorld(const RenderedAxis& axis, const Limb& limb, std::mt19937_64& random)
      : axis_(axis), limb_(limb), random_(random) {
    hand_mass = uniform(random, 0.05, 0.6);
    wall[0] = -uniform(random, 0.0, 0.05);
    wall[1] = uniform(random, 0.0, 0.05);
    wall_stiffness = uniform(random, 2e3, 4e4);
    lag_s = uniform(random, 1e-4, 2e-3);
    mass = axis.mass * uniform(random, 0.95, 1.05);
    damping = axis.damping * uniform(random, 0.8, 1.2);
    friction = 0.01 * axis.limit * uniform(random, 0.0, 1.5);
  }

  double hand_mass, wall[2], wall_stiffness, lag_s, mass, damping, friction;
  double held_body = 0.0;       ///< mass in the hand [kg]
  double therapist_mass = 0.0;  ///< holds the device, too
  double knocks_per_s = 0.0;
  double pulses = 0.0, pulses_hz = 1.0;   ///< efforts of an exercise, as a share of the limit
  std::shared_ptr<ActivePatient> person;  ///< what the limb does by itself; null: nothing
  /// What the drive gives for the effort that arrives [N].
  std::function<double(double)> drive = [](double effort) { return effort; };

  [[nodiscard]] double read() const { return std::round(q_ / axis_.step) * axis_.step; }
  [[nodiscard]] double speed() const { return v_; }
  [[nodiscard]] double work_j() const { return work_j_; }
  [[nodiscard]] double sent() const { return sent_; }
  [[nodiscard]] double acting() const { return acting_; }  ///< the drive's effort now
  [[nodiscard]] double time_s() const { return time_s_; }

  /// Renders, then passes a period.
  void pass() {
    render();
    push();
    const double arrived = drive(before_);
    before_ = sent_;
    act();
    const bool holds = person == nullptr || person->holds(0);
    const double moved = (holds ? limb_.mass : 0.0) + therapist_mass + mass;
    for (int i = 0; i < kSteps; ++i) {
      constexpr double h = kPeriod_s / kSteps;
      acting_ += (arrived - acting_) * std::min(1.0, h / lag_s);
      const double hand =
          (holds ? impedance() : 0.0) + pushed(h) + own_ + (own_end_ - own_) * i / kSteps +
          limb_.tremor * std::sin(2.0 * std::numbers::pi * limb_.tremor_hz * time_s_);
      const double v = v_ + h * (acting_ + hand - damping * v_) / moved;
      const double held = h * friction / moved;
      const double next = std::abs(v) <= held ? 0.0 : v - std::copysign(held, v);
      work_j_ += acting_ * 0.5 * (v_ + next) * h;
      v_ = next;
      q_ += h * v_;
      if (std::abs(q_) > 0.1) q_ = std::copysign(0.1, q_), v_ = 0.0;
      time_s_ += h;
    }
  }

 private:
  void render() {
    const double q = read();
    filtered_ += (1.0 - std::exp(-2.0 * std::numbers::pi * 30.0 * kPeriod_s)) *
                 ((q - last_) / kPeriod_s - filtered_);
    last_ = q;
    double wanted = -coupling(q);
    const double wave = std::sin(2.0 * std::numbers::pi * pulses_hz * time_s_);
    wanted += pulses * axis_.limit * (wave > 0.3 ? 0.5 : -0.1);
    wanted = std::clamp(wanted, -axis_.limit, axis_.limit);
    const double most = 250.0 * axis_.limit * kPeriod_s;
    sent_ += std::clamp(wanted - sent_, -most, most);
    const double moved = hand_mass + held_body;
    for (int i = 0; i < kSteps; ++i) {
      constexpr double h = kPeriod_s / kSteps;
      const double into = hand_ - std::clamp(hand_, wall[0], wall[1]);
      double wall_push =
          into == 0.0 ? 0.0
                      : -wall_stiffness * into - std::sqrt(wall_stiffness * moved) * hand_speed_;
      if (wall_push * into > 0.0) wall_push = 0.0;
      hand_speed_ += h * (coupling(q) + wall_push) / moved;
      hand_ += h * hand_speed_;
    }
  }
  [[nodiscard]] double coupling(double q) const {
    return axis_.k * (q - hand_) + axis_.b * (filtered_ - hand_speed_);
  }
  // A person aims elsewhere now and then; somebody knocks.
  void push() {
    if (limb_.moves && time_s_ >= until_s_) {
      from_ = to_;
      to_ = uniform(random_, -0.05, 0.05);
      since_s_ = time_s_;
      until_s_ = time_s_ + uniform(random_, 0.15, 1.5);
    }
    if (knock_left_s_ <= 0.0 && uniform(random_, 0.0, 1.0) < knocks_per_s * kPeriod_s) {
      const double hard = uniform(random_, 0.0, 1.0);
      knock_ = uniform(random_, -5.0, 5.0) * axis_.limit * hard * hard;
      knock_left_s_ = knock_s_ = uniform(random_, 0.002, 0.03);
    }
  }
  void act() {
    if (person == nullptr) return;
    person->advance({AxisPosition(1, q_), AxisVelocity(1, v_), AxisEffort(1, acting_),
                     AxisEffort(1, impedance())});
    own_ = person->begin()[0];
    own_end_ = person->end()[0];
  }
  [[nodiscard]] double impedance() const {
    return limb_.stiffness * (aim() - q_) - limb_.damping * v_;
  }
  double pushed(double h) {
    if (knock_left_s_ <= 0.0) return 0.0;
    knock_left_s_ -= h;
    return knock_ * std::sin(std::numbers::pi * std::max(0.0, knock_left_s_) / knock_s_);
  }
  [[nodiscard]] double aim() const {
    if (until_s_ <= since_s_) return 0.0;
    const double s = (time_s_ - since_s_) / (until_s_ - since_s_);
    return from_ + (to_ - from_) * s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
  }

  RenderedAxis axis_;
  Limb limb_;
  std::mt19937_64& random_;
  double q_ = 0.0, v_ = 0.0, acting_ = 0.0, sent_ = 0.0, before_ = 0.0, work_j_ = 0.0;
  double hand_ = 0.0, hand_speed_ = 0.0, filtered_ = 0.0, last_ = 0.0;
  double from_ = 0.0, to_ = 0.0, since_s_ = 0.0, until_s_ = 0.0, time_s_ = 0.0;
  double knock_ = 0.0, knock_s_ = 1.0, knock_left_s_ = 0.0;
  double own_ = 0.0, own_end_ = 0.0;  ///< of the person, at the period's ends
};

/// The passport's model of an axis of the world: delay of a period, and lag.
inline ResponseModel modelOf(const RenderedAxis& axis) {
  return {axis.mass, axis.damping, 2e-3, axis.limit};
}

}  // namespace wholehand::test
