// The simulated "hardware" of 02_own_device and 05_run_and_record: a handle on three rails, which a
// person pulls along one of them. A driver of real hardware accesses its bus where this one
// computes.
#pragma once

#include "wholehand/wholehand.hpp"

class Rails final : public wholehand::HapticDevice {
 public:
  Rails(int pulled_axis, double pull_n) : pulled_axis_(pulled_axis), pull_n_(pull_n) {}

  wholehand::Expected<wholehand::Done> open() override {
    return wholehand::Done{};  // a real driver finds, calibrates and powers the device
  }
  wholehand::Expected<wholehand::Done> ready() override {
    return wholehand::Done{};  // a real driver checks that the device is calibrated and at rest
  }
  wholehand::Fault read(wholehand::DeviceReading& reading, int elapsed_periods) noexcept override {
    constexpr double kMass_kg = 0.5, kFriction_n_s_m = 20.0, kPeriod_s = 1e-3;
    for (int period = 0; period < elapsed_periods; ++period) {
      for (int a = 0; a < 3; ++a) {
        const double pull_n = a == pulled_axis_ ? pull_n_ : 0.0;
        const double force_n = effort_[a] + pull_n - kFriction_n_s_m * velocity_[a];
        velocity_[a] += kPeriod_s * force_n / kMass_kg;
        position_[a] += kPeriod_s * velocity_[a];
      }
    }
    reading.q_m = position_;
    return wholehand::Fault::kNone;  // kDeviceRead lets the renderer ramp to the neutral effort
  }
  wholehand::Fault write(const wholehand::AxisEffort& effort) noexcept override {
    effort_ = effort;
    return wholehand::Fault::kNone;
  }
  void close() noexcept override {}

 private:
  int pulled_axis_;
  double pull_n_;
  wholehand::AxisPosition position_{3};
  wholehand::AxisVelocity velocity_{3};
  wholehand::AxisEffort effort_{3};
};
