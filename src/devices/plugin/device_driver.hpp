#pragma once

#include "loop/core/expected.hpp"
#include "loop/core/real_time.hpp"
#include "wholehand/device.h"

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

/// Identity of the device as the driver reports it; fields are empty where unknown.
struct DriverIdentity {
  std::string serial, firmware, sdk;
  std::string driver_sha256;  ///< digest of the driver's file, its settings, and the files that
                              ///< these name
  bool simulated = false;     ///< identity of a simulated plant, on which people learn
                              ///< commissioning
};

/// Prefix of control()'s error for a verb that the device does not support.
inline constexpr const char* kUnsupportedPrefix = "the device has no way to ";

/// What people are told while a call of the driver lasts longer than it may.
inline constexpr const char* kNoAnswer =
    "The robot does not answer. Press the emergency stop on the device now.";
inline constexpr const char* kAnswersAgain = "The robot answers again.";

/// Longest time of a call of the driver, unless the driver states another one for opening or
/// switching. A driver that takes longer does not answer.
inline constexpr double kCallWithin_s = 0.05;

/// Times of the newest messages between the loop and another process that calls the driver [ns],
/// CLOCK_MONOTONIC. All 0: the loop calls the driver itself, and nothing stands between.
struct WayTimes {
  std::int64_t handed_ns = 0;   ///< that process handed over the sample that was read last
  std::uint64_t command = 0;    ///< number of the last command or probe() that reached it
  std::int64_t sent_ns = 0;     ///< when the loop sent that one
  std::int64_t arrived_ns = 0;  ///< when that process had passed it on to the driver
};

/// A driver with the interface of device.h, in this process or in a host. One thread at a time:
/// control() is not called while a loop reads and writes.
class DeviceDriver {
 public:
  virtual ~DeviceDriver() = default;

  /// Where the driver runs, for messages: "the driver ./rails.so", "the host desk".
  [[nodiscard]] virtual std::string where() const = 0;
  /// Name that the driver gives itself.
  [[nodiscard]] virtual std::string name() const = 0;
  /// Axes in the order of positions and efforts; constant.
  [[nodiscard]] virtual const std::vector<wh_axis>& axes() const noexcept = 0;
  /// Finds a lost device again. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> reconnect() { return Done{}; }
  /// Carries out a verb of device.h; returns when it is done. Not real-time safe.
  [[nodiscard]] virtual Expected<Done> control(std::uint32_t verb, double argument) = 0;
  /// Enables the device like WH_ENABLE, with these efforts from the first moment. Not real-time
  /// safe.
  [[nodiscard]] virtual Expected<Done> enable(const wh_command& /*neutral*/) {
    return control(WH_ENABLE, 0.0);
  }
  /// Longest time of enabling, disabling and closing while the device answers [s].
  [[nodiscard]] virtual double switchesWithin_s() const noexcept { return kCallWithin_s; }
  /// True when enable() begins with the given efforts.
  [[nodiscard]] virtual bool enablesAtNeutral() const noexcept { return false; }
  /// True when the device is held at its neutral efforts between two sessions.
  [[nodiscard]] virtual bool holds() const noexcept { return false; }
  /// Like wh_plugin.read and wh_plugin.write: >= 0 is success.
  [[nodiscard]] WHOLEHAND_RT virtual int read(wh_sample& sample) noexcept = 0;
  [[nodiscard]] WHOLEHAND_RT virtual int write(const wh_command& command) noexcept = 0;

  /// Sends a message by the way of the commands; it reaches no driver and no motor. Real-time safe.
  WHOLEHAND_RT virtual void probe() noexcept {}
  /// Times of the newest messages, from what read() has read. Real-time safe.
  [[nodiscard]] WHOLEHAND_RT virtual WayTimes way() const noexcept { return {}; }

  /// Identity of the device, known once it is open; constant.
  [[nodiscard]] const DriverIdentity& identity() const noexcept { return identity_; }

 protected:
  DriverIdentity identity_;
};

/// State of a device for display, without its positions.
struct DeviceFacts {
  bool enabled = false, homed = false, silenced = false;
  /// Highest temperature of all axes [°C]; NaN: unknown.
  double temperature_c = std::numeric_limits<double>::quiet_NaN();
  std::int64_t sampled_ns = 0;  ///< time of the newest sample, CLOCK_MONOTONIC; 0: none yet
  bool overdue = false;         ///< a call of the driver lasts longer than it may
};

/// A driver that publishes its newest sample's state to other threads, at the cost of a few stores
/// per tick.
class ObservedDriver final : public DeviceDriver {
 public:
  explicit ObservedDriver(std::shared_ptr<DeviceDriver> driver) : driver_(std::move(driver)) {
    identity_ = driver_->identity();
  }

  /// Any thread. Each field comes from the newest sample; the fields are not read atomically
  /// together.
  [[nodiscard]] DeviceFacts facts() const noexcept;

  [[nodiscard]] std::string where() const override { return driver_->where(); }
  [[nodiscard]] std::string name() const override { return driver_->name(); }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override {
    return driver_->axes();
  }
  [[nodiscard]] Expected<Done> reconnect() override;
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override;
  [[nodiscard]] Expected<Done> enable(const wh_command& neutral) override;
  [[nodiscard]] double switchesWithin_s() const noexcept override {
    return driver_->switchesWithin_s();
  }
  [[nodiscard]] bool enablesAtNeutral() const noexcept override {
    return driver_->enablesAtNeutral();
  }
  [[nodiscard]] bool holds() const noexcept override { return driver_->holds(); }
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept override;
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept override;
  WHOLEHAND_RT void probe() noexcept override { driver_->probe(); }
  [[nodiscard]] WHOLEHAND_RT WayTimes way() const noexcept override { return driver_->way(); }

 private:
  std::shared_ptr<DeviceDriver> driver_;
  /// Time by which the call under way has to return, CLOCK_MONOTONIC; 0: no call.
  std::atomic<std::int64_t> due_ns_{0};
  std::atomic<std::uint32_t> status_{0};
  std::atomic<double> temperature_c_{std::numeric_limits<double>::quiet_NaN()};
  std::atomic<std::int64_t> sampled_ns_{0};
};

static_assert(std::atomic<double>::is_always_lock_free);
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

}  // namespace wholehand
