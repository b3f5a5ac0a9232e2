#pragma once

#include "device/haptic_device.hpp"

#include <limits>
#include <utility>
#include <vector>

namespace wholehand::testing {

/// A fault to inject: what goes wrong in which ticks (counted by reads since open, from 0).
struct InjectedFault {
  enum class Kind { kNanPosition, kInfinitePosition, kShortReading, kReadFails, kWriteFails };
  Kind kind = Kind::kReadFails;
  int first_tick = 0;
  int last_tick = 0;  ///< inclusive
  int axis = 0;       ///< of the position that becomes NaN or infinite
};

/// Passes everything on to another device, but for the faults it injects. A failed read leaves the
/// reading as it was, yet time passes in the device behind; a failed write does not reach it.
class FaultyDevice final : public HapticDevice {
 public:
  FaultyDevice(HapticDevice& device, std::vector<InjectedFault> faults)
      : device_(device), faults_(std::move(faults)) {}

  [[nodiscard]] Expected<Done> open() override {
    tick_ = -1;
    return device_.open();
  }

  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override {
    ++tick_;
    DeviceReading truth;
    const Fault fault = device_.read(truth, elapsed_periods);
    if (now(InjectedFault::Kind::kReadFails) != nullptr) return fault | Fault::kDeviceRead;
    if (const InjectedFault* f = now(InjectedFault::Kind::kNanPosition)) {
      truth.q_m[f->axis] = std::numeric_limits<double>::quiet_NaN();
    }
    if (const InjectedFault* f = now(InjectedFault::Kind::kInfinitePosition)) {
      truth.q_m[f->axis] = std::numeric_limits<double>::infinity();
    }
    if (now(InjectedFault::Kind::kShortReading) != nullptr) {
      AxisPosition fewer(truth.q_m.size() - 1);
      for (int i = 0; i < fewer.size(); ++i) fewer[i] = truth.q_m[i];
      truth.q_m = fewer;
    }
    reading = truth;
    return fault;
  }

  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override {
    written_ = effort;
    if (now(InjectedFault::Kind::kWriteFails) != nullptr) return Fault::kDeviceWrite;
    return device_.write(effort);
  }

  void close() noexcept override { device_.close(); }

  /// The last effort somebody tried to write.
  [[nodiscard]] const AxisEffort& written() const noexcept { return written_; }
  /// The reads since open, less one.
  [[nodiscard]] int tick() const noexcept { return tick_; }

 private:
  [[nodiscard]] const InjectedFault* now(InjectedFault::Kind kind) const noexcept {
    for (const InjectedFault& f : faults_) {
      if (f.kind == kind && tick_ >= f.first_tick && tick_ <= f.last_tick) return &f;
    }
    return nullptr;
  }

  HapticDevice& device_;
  std::vector<InjectedFault> faults_;
  AxisEffort written_;
  int tick_ = -1;
};

}  // namespace wholehand::testing
