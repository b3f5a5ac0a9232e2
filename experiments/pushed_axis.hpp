#pragma once

#include "loop/device/haptic_device.hpp"

#include <cmath>

namespace wholehand {

/// Device with one moving axis, computed by its exact solution with one tick of output delay. A
/// constant force pushes the axis. Until kSettled_s it has 20 N·s/m more damping; later it is
/// knocked once. All other axes stand still.
class PushedAxis : public HapticDevice {
 public:
  static constexpr double kMass_kg = 0.5, kDamping_n_s_m = 1.0, kPush_n = 3.0, kKnock_n = 0.5;
  static constexpr double kSettled_s = 1.5, kKnock_s = 2.0, kKnockEnds_s = 2.02;

  PushedAxis(AxisPosition start, int axis, double period_s)
      : q_(start), axis_(axis), period_s_(period_s) {}
  [[nodiscard]] Expected<Done> open() override { return Done{}; }
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  [[nodiscard]] Fault read(DeviceReading& reading, int) noexcept override {
    if (reads_++ > 0) advance();
    reading.q_m = q_;
    return Fault::kNone;
  }
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override {
    written_n_ = effort[axis_];
    return Fault::kNone;
  }
  void close() noexcept override {}
  [[nodiscard]] double velocity() const noexcept { return v_; }

 private:
  void advance() noexcept {
    const double t = (reads_ - 2) * period_s_;
    const double b = kDamping_n_s_m + (t < kSettled_s ? 20.0 : 0.0);
    const double knock = t >= kKnock_s && t < kKnockEnds_s ? kKnock_n : 0.0;
    const double force = acting_n_ - kPush_n - knock;
    acting_n_ = written_n_;  // one tick of delay
    const double decay = std::exp(-b / kMass_kg * period_s_), drift = force / b;
    q_[axis_] += drift * period_s_ + (v_ - drift) * kMass_kg / b * (1.0 - decay);
    v_ = drift + (v_ - drift) * decay;
  }

  AxisPosition q_;
  int axis_;
  double period_s_, v_ = 0.0, acting_n_ = 0.0, written_n_ = 0.0;
  int reads_ = 0;
};

}  // namespace wholehand
