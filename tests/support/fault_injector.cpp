#include "support/fault_injector.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <utility>

namespace wholehand {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Offset of a reading in a tick. The offset of a drift remains after its last tick.
double offset(const InjectedFault& fault, int tick) noexcept {
  switch (fault.kind) {
    case InjectedKind::kEncoderJump:
      return tick >= fault.first_tick && tick <= fault.last_tick ? fault.size : 0.0;
    case InjectedKind::kOverSpeed:
    case InjectedKind::kLeavesWorkspace:
      return fault.size *
             std::clamp(tick - fault.first_tick + 1, 0, fault.last_tick - fault.first_tick + 1);
    default:
      return 0.0;
  }
}

AxisPosition withoutLast(const AxisPosition& q) noexcept {
  AxisPosition fewer(q.size() - 1);
  for (int i = 0; i < fewer.size(); ++i) fewer[i] = q[i];
  return fewer;
}

}  // namespace

bool hasAxis(InjectedKind kind) noexcept {
  switch (kind) {
    case InjectedKind::kNanPosition:
    case InjectedKind::kInfinitePosition:
    case InjectedKind::kNegativeInfinitePosition:
    case InjectedKind::kEncoderJump:
    case InjectedKind::kEncoderStuck:
    case InjectedKind::kOverSpeed:
    case InjectedKind::kLeavesWorkspace:
      return true;
    default:
      return false;
  }
}

InjectedFault faultBeyond(const DeviceModel& device, double period_s, InjectedKind kind, int axis,
                          int first_tick, int last_tick) {
  const double way = device.axes[axis].speed_limit * period_s;  // largest motion in a period
  InjectedFault fault{kind, first_tick, last_tick, axis, 0.0};
  switch (kind) {
    case InjectedKind::kEncoderJump:
      fault.size = 4.0 * way + 4.0 * device.axes[axis].encoder_step;
      break;
    case InjectedKind::kOverSpeed:
      fault.size = 2.0 * way;
      break;
    case InjectedKind::kLeavesWorkspace:
      fault.size = 0.25 * way;  // added to the person's motion
      break;
    case InjectedKind::kLateTicks:
      fault.size = 1.0;
      break;
    case InjectedKind::kLongGap:
      fault.size = std::ceil(1.5 * device.watch.longest_gap_s / period_s);
      break;
    default:
      break;
  }
  return fault;
}

InjectedFault faultAtRandom(const DeviceModel& device, double period_s, InjectedKind kind,
                            int first_tick, int last_tick, int lasts_ticks, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto below = [&random](int count) {
    return static_cast<int>(random() % static_cast<std::uint64_t>(count));
  };
  const int axis = below(device.axisCount());
  const int first = first_tick + below(last_tick - first_tick + 1);
  return faultBeyond(device, period_s, kind, axis, first, first + lasts_ticks - 1);
}

FaultInjector::FaultInjector(HapticDevice& device, std::vector<InjectedFault> faults,
                             bool simulated)
    : device_(device), faults_(std::move(faults)), simulated_(simulated) {}

Expected<Done> FaultInjector::open() {
  tick_ = -1;
  stuck_at_ = AxisPosition(kMaxAxes, kNan);
  return device_.open();
}

Expected<Done> FaultInjector::ready() {
  const auto refuses = [this](InjectedKind kind) { return at(0, kind) != nullptr; };
  if (refuses(InjectedKind::kNotReady)) {
    return fileFault("", "the device is not ready", "switch its drives on");
  }
  if (refuses(InjectedKind::kNotCalibrated)) {
    return fileFault("", "the device is not calibrated", "calibrate it");
  }
  if (refuses(InjectedKind::kMoving)) {
    return fileFault("", "the device is moving", "wait until it is at rest");
  }
  return device_.ready();
}

Expected<Done> FaultInjector::enable() {
  return device_.enable();
}

Fault FaultInjector::read(DeviceReading& reading, int elapsed_periods) noexcept {
  ++tick_;
  DeviceReading truth;
  const Fault fault = device_.read(truth, elapsed_periods);
  if (at(tick_, InjectedKind::kReadFails) != nullptr) return fault | Fault::kDeviceRead;
  corrupt(truth);
  reading = truth;
  return fault;
}

void FaultInjector::corrupt(DeviceReading& reading) noexcept {
  for (const InjectedFault& fault : faults_) {
    if (!hasAxis(fault.kind) || fault.axis >= reading.q_m.size()) continue;
    double& q = reading.q_m[fault.axis];
    q += offset(fault, tick_);
    if (tick_ < fault.first_tick || tick_ > fault.last_tick) continue;
    if (fault.kind == InjectedKind::kNanPosition) q = kNan;
    if (fault.kind == InjectedKind::kInfinitePosition) q = kInfinity;
    if (fault.kind == InjectedKind::kNegativeInfinitePosition) q = -kInfinity;
    if (fault.kind == InjectedKind::kEncoderStuck) {
      if (std::isnan(stuck_at_[fault.axis])) stuck_at_[fault.axis] = q;
      q = stuck_at_[fault.axis];
    }
  }
  if (at(tick_, InjectedKind::kShortReading) != nullptr) reading.q_m = withoutLast(reading.q_m);
}

Fault FaultInjector::write(const AxisEffort& effort) noexcept {
  written_ = effort;
  if (at(tick_, InjectedKind::kWriteFails) != nullptr) return Fault::kDeviceWrite;
  return device_.write(effort);
}

std::uint32_t FaultInjector::nextElapsedPeriods() const noexcept {
  std::uint32_t elapsed = 1;
  for (const InjectedFault& fault : faults_) {
    const bool now = tick_ + 1 >= fault.first_tick && tick_ + 1 <= fault.last_tick;
    const bool late = fault.kind == InjectedKind::kLateTicks ||
                      (fault.kind == InjectedKind::kLongGap && tick_ + 1 == fault.first_tick);
    if (now && late) elapsed += static_cast<std::uint32_t>(fault.size);
  }
  return elapsed;
}

const InjectedFault* FaultInjector::at(int tick, InjectedKind kind) const noexcept {
  for (const InjectedFault& fault : faults_) {
    if (fault.kind == kind && tick >= fault.first_tick && tick <= fault.last_tick) return &fault;
  }
  return nullptr;
}

}  // namespace wholehand
