#pragma once

#include "core/expected.hpp"
#include "device/host/host_segment.hpp"
#include "device/plugin/device_driver.hpp"
#include "model/device_model.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace wholehand {

/// A driver that runs in a host (`wholehand device-host`). Reads and writes are copies in shared
/// memory: no system call. Where the host dies or stands still its samples do, which is
/// Fault::kStaleSample in PluginDevice.
class HostedDriver final : public DeviceDriver {
 public:
  /// Refused as HostSegment::attach().
  [[nodiscard]] static Expected<std::shared_ptr<HostedDriver>> connect(const std::string& name);

  /// The host ramps to the neutral effort of its device file: it must be that of the loop's.
  [[nodiscard]] Diagnostics differences(const DeviceModel& model) const;

  /// When the host's newest cycle was that the loop has read, CLOCK_MONOTONIC [ns]; 0: none. Any
  /// thread.
  [[nodiscard]] std::int64_t cycleNs() const noexcept {
    return cycle_ns_.load(std::memory_order_relaxed);
  }
  /// Why the host let go in this session, as far as the loop has read. Any thread.
  [[nodiscard]] HostReason reason() const noexcept {
    return reason_.load(std::memory_order_relaxed);
  }

  [[nodiscard]] std::string where() const override { return "the host " + name_; }
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  /// WH_ENABLE begins a session of the host, and connects anew where the host was started again.
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override;
  /// WH_SILENCED from the cycle on in which the host let go.
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
  std::atomic<HostReason> reason_{HostReason::kNone};
};

}  // namespace wholehand
