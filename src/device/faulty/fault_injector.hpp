#pragma once

#include "device/haptic_device.hpp"
#include "model/device_model.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// What goes wrong between a device and the loop.
enum class InjectedKind {
  kReadFails,
  kWriteFails,  ///< the effort does not reach the device
  kNanPosition,
  kInfinitePosition,
  kNegativeInfinitePosition,
  kShortReading,     ///< one axis less
  kEncoderJump,      ///< the reading is off by `size`
  kEncoderStuck,     ///< the reading stays what it was
  kOverSpeed,        ///< the reading runs away, `size` further in every tick
  kLeavesWorkspace,  ///< the same, slowly
  kLateTicks,        ///< the loop comes `size` periods late, tick after tick
  kLongGap,          ///< once
  kNotReady,         ///< at arming, as are the next two
  kNotCalibrated,
  kMoving,
};

/// One fault, from its first to its last tick.
struct InjectedFault {
  InjectedKind kind = InjectedKind::kReadFails;
  int first_tick = 0;  ///< counted by reads since open(), from 0: arming makes the first one
  int last_tick = 0;   ///< inclusive
  int axis = 0;        ///< of the faults that have one
  double size = 0.0;   ///< [m or rad], or periods
};

/// True where a fault of that kind is one of an axis.
[[nodiscard]] bool hasAxis(InjectedKind kind) noexcept;

/// A fault just large enough to be one by the limits of the device's file: a jump of four times
/// what the fastest motion makes in a period, twice the speed limit, a quarter of it out of the
/// workspace, one period late, a gap half as long again as is allowed.
[[nodiscard]] InjectedFault faultBeyond(const DeviceModel& device, double period_s,
                                        InjectedKind kind, int axis, int first_tick, int last_tick);

/// The same on an axis and from a tick on that the seed draws, both alike likely.
[[nodiscard]] InjectedFault faultAtRandom(const DeviceModel& device, double period_s,
                                          InjectedKind kind, int first_tick, int last_tick,
                                          int lasts_ticks, std::uint64_t seed);

/// Passes everything on to another device, but for the faults it injects. A failed read leaves the
/// reading as it was, yet time passes in the device behind. Real-time safe where a device is.
class FaultInjector final : public HapticDevice {
 public:
  /// @param simulated what it says of itself: false has everything watched, as on a real device
  /// @pre device outlives this
  FaultInjector(HapticDevice& device, std::vector<InjectedFault> faults, bool simulated = false);

  [[nodiscard]] Expected<Done> open() override;
  [[nodiscard]] Expected<Done> ready() override;
  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  void close() noexcept override { device_.close(); }

  /// What the loop is to say to the next tick, 1 + the periods it is late: a device cannot make its
  /// loop late by itself.
  [[nodiscard]] std::uint32_t nextElapsedPeriods() const noexcept;
  /// The last effort somebody tried to write.
  [[nodiscard]] const AxisEffort& written() const noexcept { return written_; }
  /// The reads since open, less one.
  [[nodiscard]] int tick() const noexcept { return tick_; }
  /// Nothing goes wrong from now on: repaired.
  void clear() noexcept { faults_.clear(); }

 private:
  [[nodiscard]] const InjectedFault* at(int tick, InjectedKind kind) const noexcept;
  void spoil(DeviceReading& reading) noexcept;

  HapticDevice& device_;
  std::vector<InjectedFault> faults_;
  bool simulated_;
  AxisEffort written_;
  AxisPosition stuck_at_;  ///< NaN where an axis is not stuck
  int tick_ = -1;
};

}  // namespace wholehand
