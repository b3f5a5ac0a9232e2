#pragma once

#include "core/expected.hpp"
#include "device/host/effort_guard.hpp"
#include "device/host/shared_frame.hpp"
#include "device/plugin/device_driver.hpp"
#include "model/device_model.hpp"
#include "realtime/spsc_queue.hpp"

#include <atomic>
#include <cstdint>

namespace wholehand {

/// What happened in a host, for people and logs.
struct HostEvent {
  HostPhase phase = HostPhase::kIdle;  ///< that has begun
  HostReason reason = HostReason::kNone;
  std::uint64_t session = 0;
  std::int64_t at_ns = 0;           ///< CLOCK_MONOTONIC
  std::int64_t silent_ns = 0;       ///< age of the loop's newest command then
  std::int64_t longest_gap_ns = 0;  ///< between two cycles of the host since the last event
  std::int64_t loop_pid = 0;
};

/// "the loop was silent for 20 ms": what a person is told of a reason.
[[nodiscard]] const char* describe(HostReason reason) noexcept;

/// The effort of every axis of the driver, from the device file: axes that it does not name get 0.
/// @pre the file fits the driver (PluginDevice::make)
[[nodiscard]] GuardConfig guardConfig(const DeviceDriver& driver, const DeviceModel& model,
                                      double period_s);

/// Fills in what a loop must know before it may connect; `magic` last.
void describeDevice(SharedFrame& frame, const DeviceDriver& driver, const GuardConfig& config,
                    std::int64_t host_pid);

/// One device and the loop that drives it from another process. Every cycle it reads a sample,
/// publishes it, takes the loop's newest command and writes what the guard lets through.
///
/// The driver is called from the thread of cycle() only. A verb of the loop is carried out there,
/// too, where nothing is being rendered: the cycle then takes as long as the verb.
class DeviceHost {
 public:
  /// @pre driver and frame outlive it; describeDevice() has filled the frame
  /// @param now_ns the clock: CLOCK_MONOTONIC, or a simulated one
  DeviceHost(DeviceDriver& driver, SharedFrame& frame, const GuardConfig& config,
             std::int64_t (*now_ns)() noexcept);
  DeviceHost(const DeviceHost&) = delete;
  DeviceHost& operator=(const DeviceHost&) = delete;

  /// False once a requested end is reached: neutral, disabled.
  /// @param elapsed_periods 1 + periods of the host that were skipped
  [[nodiscard]] bool cycle(int elapsed_periods) noexcept;

  /// Ramps to neutral, disables the device and ends. Any thread.
  void requestEnd() noexcept { end_.store(true, std::memory_order_release); }
  /// The next thing that happened; false: nothing. One thread.
  [[nodiscard]] bool nextEvent(HostEvent& event) noexcept { return events_.try_pop(event); }

 private:
  void publish(int read_result, std::int64_t now_ns) noexcept;
  void tell(HostPhase before, std::int64_t now_ns) noexcept;
  void serve();
  // Of this session, and newer than what the guard has taken; false where it takes none any more.
  [[nodiscard]] bool isUnheard(const HostCommand& command) const noexcept;
  [[nodiscard]] bool isRendering() const noexcept;
  void carryOut(const HostRequest& request, HostAnswer& answer);

  DeviceDriver& driver_;
  SharedFrame& frame_;
  GuardConfig config_;
  std::int64_t (*now_ns_)() noexcept;
  GuardState guard_;
  HostSample sample_{};
  HostCommand command_{};
  HostRequest request_{};
  wh_command out_{};
  std::uint64_t answered_ = 0;  ///< number of the last request that was carried out
  std::uint64_t sessions_ = 0;
  std::int64_t last_cycle_ns_ = 0, longest_gap_ns_ = 0;
  bool commanded_ = false;  ///< a command has ever come
  std::atomic<bool> end_{false};
  SpscQueue<HostEvent> events_{64};
};

}  // namespace wholehand
