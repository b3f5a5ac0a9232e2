#pragma once

#include "devices/host/host_segment.hpp"
#include "devices/plugin/device_driver.hpp"
#include "loop/core/expected.hpp"
#include "loop/model/device_model.hpp"

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
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

  /// Reason why the host released the device in this session, as read by the loop. Any thread.
  [[nodiscard]] ReleaseReason reason() const noexcept {
    return reason_.load(std::memory_order_relaxed);
  }

  /// What the host says now, in and between sessions. Any thread.
  [[nodiscard]] HostFacts facts() const;
  /// True from WH_ENABLE to WH_DISABLE. Any thread.
  [[nodiscard]] bool inSession() const noexcept { return in_session_.load(); }
  /// True while the host carries out a verb, when it has no cycles. Any thread.
  [[nodiscard]] bool asks() const noexcept { return asks_.load(); }

  [[nodiscard]] std::string where() const override { return "the host " + name_; }
  [[nodiscard]] std::string name() const override;
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  /// Attaches to a restarted host. Refused when its axes differ.
  [[nodiscard]] Expected<Done> reconnect() override;
  /// Carries out a verb. WH_ENABLE begins a session of the host.
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override;
  /// The driver's own time, and that of the host's requests.
  [[nodiscard]] double switchesWithin_s() const noexcept override;
  /// The host enables with the neutral efforts of its device file, and holds them until it ends.
  [[nodiscard]] bool enablesAtNeutral() const noexcept override { return true; }
  [[nodiscard]] bool holds() const noexcept override { return true; }
  /// Reads the newest sample. It has WH_SILENCED from the cycle on in which the host released the
  /// device.
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept override;
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept override;
  WHOLEHAND_RT void probe() noexcept override;
  [[nodiscard]] WHOLEHAND_RT WayTimes way() const noexcept override;

 private:
  HostedDriver(std::string name, std::unique_ptr<HostSegment> segment);
  [[nodiscard]] Expected<Done> connectAnew();
  [[nodiscard]] Expected<HostAnswer> ask(std::uint32_t verb, double argument);
  [[nodiscard]] Expected<Done> awaitSession();
  [[nodiscard]] Diagnostic no(const std::string& problem, const std::string& remedy) const;

  std::string name_;
  std::shared_ptr<HostSegment> segment_;
  mutable std::mutex replaces_;  ///< held while segment_ is replaced, and by other threads
  std::vector<wh_axis> axes_;
  std::uint64_t session_ = 0;
  std::uint64_t requests_ = 0;
  HostSample last_{};
  HostCommand command_{};
  std::uint64_t probes_ = 0;
  std::atomic<bool> in_session_{false}, asks_{false};
  std::atomic<ReleaseReason> reason_{ReleaseReason::kNone};
};

}  // namespace wholehand
