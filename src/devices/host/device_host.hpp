#pragma once

#include "devices/host/effort_guard.hpp"
#include "devices/host/host_segment.hpp"
#include "devices/plugin/device_driver.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"
#include "loop/realtime/spsc_queue.hpp"

#include <atomic>
#include <cstdint>

namespace wholehand {

/// An event of a host, for people and logs: a phase began, or the drive is no longer on although
/// the host has enabled it, or it is on again.
struct HostEvent {
  bool of_drive = false;               ///< about the drive; else a phase began
  HostPhase phase = HostPhase::kIdle;  ///< phase that began, or goes on
  DriveState drive = DriveState::kUnheard;
  std::int64_t heard_ns = 0;  ///< age of what the drive said last
  ReleaseReason reason = ReleaseReason::kNone;
  std::uint64_t session = 0;
  std::int64_t at_ns = 0;           ///< CLOCK_MONOTONIC
  std::int64_t silent_ns = 0;       ///< age of the loop's newest command at that time
  std::int64_t longest_gap_ns = 0;  ///< longest time between two cycles since the last event
  std::int64_t loop_pid = 0;
};

/// Text of a reason for people: "the loop was silent for 20 ms".
[[nodiscard]] const char* describe(ReleaseReason reason) noexcept;

/// Guard configuration of every axis of the driver, from the device file. Axes that the file does
/// not name get no effort.
/// @pre the file fits the driver (PluginDevice::make)
[[nodiscard]] GuardConfig guardConfig(const DeviceDriver& driver, const DeviceModel& model,
                                      double period_s);

/// Fills the frame with the description that a loop reads before it connects; sets `magic` last.
void describeDevice(SharedFrame& frame, const DeviceDriver& driver, const GuardConfig& config,
                    std::int64_t host_pid);

/// Serves one device to a loop in another process. Each cycle reads a sample, publishes it, takes
/// the loop's newest command and writes the effort that the guard allows.
///
/// A device with weight is enabled with its neutral efforts, and keeps them between two sessions
/// until the host ends. If its drive is off meanwhile, the host says so and enables it again only
/// when a loop arms.
///
/// Only the thread of cycle() calls the driver. It also carries out the verbs of the loop while
/// nothing is rendered; such a cycle takes as long as the verb.
class DeviceHost {
 public:
  /// @pre driver and frame outlive this object; describeDevice() has filled the frame
  /// @param now_ns clock: CLOCK_MONOTONIC, or a simulated one
  DeviceHost(DeviceDriver& driver, SharedFrame& frame, const GuardConfig& config,
             std::int64_t (*now_ns)() noexcept);
  DeviceHost(const DeviceHost&) = delete;
  DeviceHost& operator=(const DeviceHost&) = delete;

  /// Runs one cycle. False when a requested end is complete: neutral and disabled.
  /// @param elapsed_periods 1 + skipped periods of the host
  [[nodiscard]] bool cycle(int elapsed_periods) noexcept;

  /// Ramps to neutral, disables the device and ends. Any thread.
  void requestEnd() noexcept { end_.store(true, std::memory_order_release); }
  /// Pops the next event; false when there is none. One thread.
  [[nodiscard]] bool nextEvent(HostEvent& event) noexcept { return events_.try_pop(event); }

 private:
  void publish(int read_result, std::int64_t now_ns) noexcept;
  void reportChange(HostPhase before, std::int64_t now_ns) noexcept;
  void hearDrive(int read_result, bool written, std::int64_t now_ns) noexcept;
  void reportDrive(std::int64_t now_ns) noexcept;
  void noteArrival() noexcept;
  [[nodiscard]] DriveState driveState(int read_result, bool written,
                                      std::int64_t now_ns) const noexcept;
  void serve();
  // True when the command belongs to this session and is newer than the last one taken; false when
  // the guard takes no more commands.
  [[nodiscard]] bool isNew(const HostCommand& command) const noexcept;
  [[nodiscard]] bool isRendering() const noexcept;
  void carryOut(const HostRequest& request, HostAnswer& answer);
  [[nodiscard]] Expected<Done> enable();
  [[nodiscard]] bool isOn() noexcept;
  [[nodiscard]] Expected<Done> disable();

  DeviceDriver& driver_;
  SharedFrame& frame_;
  GuardConfig config_;
  std::int64_t (*now_ns_)() noexcept;
  GuardState guard_;
  HostSample sample_{};
  HostCommand command_{};
  std::uint64_t arrived_session_ = 0;  ///< session of the newest command taken
  HostRequest request_{};
  wh_command out_{};
  std::uint64_t answered_ = 0;  ///< number of the last completed request
  std::uint64_t sessions_ = 0;
  std::int64_t last_cycle_ns_ = 0, longest_gap_ns_ = 0;
  bool commanded_ = false;             ///< a command was received
  bool held_ = false;                  ///< enabled between two sessions
  std::uint64_t heard_ = 0;            ///< sequence of the drive's newest sample
  std::int64_t still_since_ns_ = 0;    ///< time since which the drive gives nothing new
  std::int64_t asked_ns_ = 0;          ///< time since which the drive should be on
  DriveState told_ = DriveState::kOn;  ///< state of the drive in the last event
  std::atomic<bool> end_{false};
  SpscQueue<HostEvent> events_{64};
};

}  // namespace wholehand
