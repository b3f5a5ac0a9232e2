#pragma once

#include "devices/host/host_segment.hpp"
#include "devices/plugin/device_driver.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// A driver that runs in a host process (`wholehand device-host`). Reads and writes copy shared
/// memory without a system call. When the host dies or stalls, its samples stand still;
/// PluginDevice reports Fault::kStaleSample.
class HostedDriver final : public DeviceDriver {
 public:
  /// Connects to a host. Refused like HostSegment::attach().
  [[nodiscard]] static Expected<std::shared_ptr<HostedDriver>> connect(const std::string& name);

  /// Differences between the loop's device file and the host's. The host ramps to the neutral
  /// effort of its own file and clamps to its own limits, so the files must agree.
  [[nodiscard]] Diagnostics differences(const DeviceModel& model) const;

  /// Time of the newest cycle of the host that the loop has read, CLOCK_MONOTONIC [ns]; 0: none.
  /// Any thread.
  [[nodiscard]] std::int64_t cycleNs() const noexcept {
    return cycle_ns_.load(std::memory_order_relaxed);
  }
  /// Reason why the host released the device in this session, as read by the loop. Any thread.
  [[nodiscard]] ReleaseReason reason() const noexcept {
    return reason_.load(std::memory_order_relaxed);
  }

  [[nodiscard]] std::string where() const override { return "the host " + name_; }
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  /// Attaches to a restarted host. Refused when its axes differ.
  [[nodiscard]] Expected<Done> reconnect() override;
  /// Carries out a verb. WH_ENABLE begins a session of the host.
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override;
  /// The host enables with the neutral efforts of its device file, and holds them until it ends.
  [[nodiscard]] bool enablesAtNeutral() const noexcept override { return true; }
  [[nodiscard]] bool holds() const noexcept override { return true; }
  /// Reads the newest sample. It has WH_SILENCED from the cycle on in which the host released the
  /// device.
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept override;
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept override;

 private:
  HostedDriver(std::string name, std::unique_ptr<HostSegment> segment);
  [[nodiscard]] Expected<Done> connectAnew();
  [[nodiscard]] Expected<HostAnswer> ask(std::uint32_t verb, double argument);
  [[nodiscard]] Expected<Done> awaitSession();
  [[nodiscard]] Diagnostic no(const std::string& problem, const std::string& remedy) const;

  std::string name_;
  std::unique_ptr<HostSegment> segment_;
  std::vector<wh_axis> axes_;
  std::uint64_t session_ = 0;
  std::uint64_t requests_ = 0;
  HostSample last_{};
  HostCommand command_{};
  std::atomic<std::int64_t> cycle_ns_{0};
  std::atomic<ReleaseReason> reason_{ReleaseReason::kNone};
};

}  // namespace wholehand
