#pragma once

#include "loop/device/haptic_device.hpp"
#include "loop/model/device_model.hpp"

#include <cstdint>
#include <vector>

namespace wholehand {

/// Faults between a device and the loop.
enum class InjectedKind {
  kReadFails,
  kWriteFails,  ///< the effort does not reach the device
  kNanPosition,
  kInfinitePosition,
  kNegativeInfinitePosition,
  kShortReading,     ///< one axis is missing
  kEncoderJump,      ///< the reading has an offset of `size`
  kEncoderStuck,     ///< the reading stays constant
  kOverSpeed,        ///< the reading drifts by `size` every tick
  kLeavesWorkspace,  ///< the same, more slowly
  kLateTicks,        ///< the loop is `size` periods late in every tick
  kLongGap,          ///< the loop is `size` periods late once
  kNotReady,         ///< at arming, like the next two
  kNotCalibrated,
  kMoving,
};

/// One fault from its first to its last tick.
struct InjectedFault {
  InjectedKind kind = InjectedKind::kReadFails;
  int first_tick = 0;  ///< counted in reads since open(), from 0; arming makes the first
  int last_tick = 0;   ///< inclusive
  int axis = 0;        ///< for faults of an axis
  double size = 0.0;   ///< [m or rad], or periods
};

/// True if a fault of that kind belongs to an axis.
[[nodiscard]] bool hasAxis(InjectedKind kind) noexcept;

/// A fault just beyond the limits of the device file: a jump of four times the fastest motion in a
/// period, twice the speed limit, a drift out of the workspace at a quarter of it, one period late,
/// a gap 1.5 times the one allowed.
[[nodiscard]] InjectedFault faultBeyond(const DeviceModel& device, double period_s,
                                        InjectedKind kind, int axis, int first_tick, int last_tick);

/// The same on a random axis and from a random tick, uniformly drawn by the seed.
[[nodiscard]] InjectedFault faultAtRandom(const DeviceModel& device, double period_s,
                                          InjectedKind kind, int first_tick, int last_tick,
                                          int lasts_ticks, std::uint64_t seed);

/// Forwards to another device and injects faults. A failed read leaves the reading unchanged, but
/// time passes in the device behind. Real-time safe if that device is.
class FaultInjector final : public HapticDevice {
 public:
  /// @param simulated value of simulated(); false enables every watchdog, as on a real device
  /// @pre device outlives this
  FaultInjector(HapticDevice& device, std::vector<InjectedFault> faults, bool simulated = false);

  [[nodiscard]] Expected<Done> open() override;
  [[nodiscard]] Expected<Done> ready() override;
  [[nodiscard]] Expected<Done> enable() override;
  [[nodiscard]] bool simulated() const noexcept override { return simulated_; }
  [[nodiscard]] Fault read(DeviceReading& reading, int elapsed_periods) noexcept override;
  [[nodiscard]] Fault write(const AxisEffort& effort) noexcept override;
  void close() noexcept override { device_.close(); }

  /// Elapsed periods that the loop must pass to the next tick: 1 + the periods it is late. A device
  /// cannot delay its own loop.
  [[nodiscard]] std::uint32_t nextElapsedPeriods() const noexcept;
  /// The last effort passed to write().
  [[nodiscard]] const AxisEffort& written() const noexcept { return written_; }
  /// Number of reads since open(), minus one.
  [[nodiscard]] int tick() const noexcept { return tick_; }
  /// Removes all faults.
  void clear() noexcept { faults_.clear(); }

 private:
  [[nodiscard]] const InjectedFault* at(int tick, InjectedKind kind) const noexcept;
  void corrupt(DeviceReading& reading) noexcept;

  HapticDevice& device_;
  std::vector<InjectedFault> faults_;
  bool simulated_;
  AxisEffort written_;
  AxisPosition stuck_at_;  ///< NaN where an axis is not stuck
  int tick_ = -1;
};

}  // namespace wholehand
