#pragma once

#include "devices/host/newest_value.hpp"
#include "drivers/frame/carrier.hpp"
#include "drivers/frame/firmware/frame.h"
#include "loop/core/expected.hpp"
#include "loop/core/real_time.hpp"
#include "wholehand/device.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Number of ignored frames, by reason.
struct FrameCounters {
  std::uint32_t broken = 0, crc_errors = 0, foreign = 0, stale = 0;
};

/// A device that uses the frame (firmware/frame.h), over any carrier. It has no thread and no clock
/// of its own. One thread, the bus, calls pump(), control() and open(); another, the loop, calls
/// read() and write(), which never wait for the first.
class FrameDevice {
 public:
  /// Waits a short time, for example 1 ms. Returns the time afterwards, CLOCK_MONOTONIC [ns].
  using Wait = std::function<std::int64_t()>;

  /// Begins a session and asks for the axes. Refused, each by name: no answer within 2 s, another
  /// version of the frame, a device that renders for another program, impossible axes.
  /// @param session a new random number for every device; not 0
  [[nodiscard]] static Expected<std::unique_ptr<FrameDevice>> open(std::unique_ptr<Carrier> carrier,
                                                                   std::uint32_t session,
                                                                   const Wait& wait);

  /// Axes as the device reports them, in its order.
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept { return axes_; }
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const std::string& serial() const noexcept { return serial_; }
  [[nodiscard]] const std::string& firmware() const noexcept { return firmware_; }
  [[nodiscard]] FrameCounters counters() const;
  [[nodiscard]] const Carrier& carrier() const noexcept { return *carrier_; }

  /// Carries out a verb of device.h. Repeats the question until it is answered, for 1 s, or 60 s
  /// for homing and self-test. WH_ENABLE then waits up to 20 ms for a later sample that has
  /// WH_ENABLED.
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument, const Wait& wait);
  /// Takes all received frames and sends the loop's newest command once; while the line is still
  /// busy with an earlier one, it sends later. The time of a sample is that of the oldest command
  /// that the device had not heard by then. The age of a sample therefore shows a delay in either
  /// direction.
  void pump(std::int64_t now_ns) noexcept;

  /// Like wh_plugin.read and wh_plugin.write. WH_FAILED: the carrier is gone; for write also: not
  /// enabled, or another number of axes. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept;
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept;

 private:
  struct PostedCommand {
    std::uint64_t number;  ///< increases with every write
    wh_command command;
  };

  FrameDevice(std::unique_ptr<Carrier> carrier, std::uint32_t session)
      : carrier_(std::move(carrier)), session_(session) {
    axes_.reserve(WF_MAX_AXES);
  }
  [[nodiscard]] Expected<Done> shakeHands(const Wait& wait);
  [[nodiscard]] Expected<Done> askAxes(const Wait& wait);
  [[nodiscard]] bool ask(wf_frame question, std::uint8_t answer, std::int64_t within_ns,
                         const Wait& wait);
  void awaitEnabledSample(const Wait& wait);
  [[nodiscard]] Diagnostic silent(const std::string& what) const;
  void sendFrame(const wf_frame& frame) noexcept;
  void sendCommand(std::int64_t now_ns) noexcept;
  [[nodiscard]] std::int64_t receivedUntil_ns(std::uint32_t heard,
                                              std::int64_t now_ns) const noexcept;
  void take(const wf_frame& frame, std::int64_t now_ns) noexcept;
  void takeSample(const wf_frame& frame, std::int64_t now_ns) noexcept;

  std::unique_ptr<Carrier> carrier_;
  std::uint32_t session_;
  std::string name_, serial_, firmware_;
  std::vector<wh_axis> axes_;

  // Used by the bus thread:
  wf_receiver receiver_{};
  wf_frame answer_{};         ///< last awaited answer
  std::uint8_t awaited_ = 0;  ///< kind of the awaited answer; 0: none
  std::uint32_t questions_ = 0;
  std::uint32_t other_session_ = 0;
  int other_version_ = 0;
  std::uint32_t last_sample_ = 0;
  wh_sample sample_{};
  bool muted_ = false;                       ///< after WH_DROP_WATCHDOG
  std::uint32_t commands_ = 0;               ///< sequence number of the last command
  std::uint32_t begun_at_ = 0;               ///< value of commands_ at WH_ENABLE; earlier commands
                                             ///< do not count
  std::array<std::int64_t, 256> sent_ns_{};  ///< time of sending, by number of the command
  std::uint64_t sent_number_ = 0;
  std::atomic<std::uint32_t> broken_{0}, crc_errors_{0}, foreign_{0}, stale_{0};

  // Shared by both threads:
  std::atomic<bool> gone_{false}, enabled_{false};
  NewestValue<wh_sample> samples_;
  NewestValue<PostedCommand> posts_;

  // Used by the loop:
  wh_sample newest_{};
  PostedCommand post_{};
};

}  // namespace wholehand
