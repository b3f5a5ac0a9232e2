#pragma once

#include "devices/plugin/device_driver.hpp"
#include "drivers/composite/composite_file.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/real_time.hpp"
#include "loop/realtime/monotonic_clock.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace wholehand {

/// Two devices as one, for example a base and a hand. One thread at a time.
///
/// Every rule for the samples of a device holds for each part. A part is lost when it gives no
/// sample, when its samples run backwards, stand still for longer than its longest gap, are older
/// than that or of the future, or when it refuses a command. Its axes are then invalid. While the
/// whole is enabled, a loss lasts until WH_DISABLE or WH_ENABLE, and the whole is not enabled
/// meanwhile. The loop ramps to neutral, and the healthy part still takes the loop's commands, down
/// to neutral.
class Composite {
 public:
  using Parts = std::array<std::shared_ptr<DeviceDriver>, 2>;

  /// Refused, with the name: an axis that its part does not have.
  /// @param now_ns the clock of the samples; real-time safe
  [[nodiscard]] static Expected<std::unique_ptr<Composite>> make(
      const CompositeConfig& config, const Parts& parts,
      std::int64_t (*now_ns)() noexcept = &monotonicNow_ns);

  /// Axes of the first part, then those of the second, in the order of the file.
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept { return axes_; }
  /// Identity of both parts, "A + B"; the serial number is empty when one part has none.
  [[nodiscard]] DriverIdentity identity() const;
  /// Carries out a verb on both parts; done when both have done it. If one cannot be enabled,
  /// neither stays enabled. WH_DROP_WATCHDOG stops all commands to a part that does not support it.
  /// The whole then counts as silenced only when both parts have released: one watchdog must not
  /// hide that the other is missing.
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument);
  /// Enables like WH_ENABLE, with these efforts from the first moment if both parts support that.
  [[nodiscard]] Expected<Done> enable(const wh_command& neutral);
  [[nodiscard]] bool enablesAtNeutral() const noexcept;
  /// Reads both parts. The whole is homed when both are, and enabled when both are; after
  /// WH_DISABLE it is enabled while one still is. A fault of one part is a fault of the whole; a
  /// part that derates may give less on its own axes only. The time is that of the older sample.
  /// When the samples are farther apart than the file allows, the axes of the older one are
  /// invalid. WH_FAILED: both parts are lost. Real-time safe if both parts are.
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept;
  /// Writes to both parts; axes that the file does not name get no effort. WH_FAILED: both parts
  /// are lost; or nothing is written, because the whole is not enabled, or the command is not
  /// finite or of another number of axes.
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept;

  /// Largest time between the two samples that read() has seen [ns].
  [[nodiscard]] std::int64_t largestSkew_ns() const noexcept { return largest_skew_ns_; }

 private:
  struct Place {
    std::size_t part, axis;  ///< part, and index of the part's axis
  };
  /// What is known about a part.
  struct PartState {
    std::int64_t longest_gap_ns = 0;
    wh_sample newest{};
    std::int64_t read_ns = 0;  ///< time of the last read
    std::int64_t new_ns = 0;   ///< time of the read that gave the newest sample
    bool begun = false;        ///< there is a newest sample
    bool current = false;      ///< a new sample came since WH_ENABLE, or since reads were paused
    bool lost = false;
    bool starved = false;  ///< it gets no more commands: its watchdog has released, or does not
                           ///< support WH_DROP_WATCHDOG
  };
  Composite(Parts parts, double longest_skew_s, std::int64_t (*now_ns)() noexcept)
      : parts_(std::move(parts)),
        longest_skew_ns_(static_cast<std::int64_t>(longest_skew_s * 1e9)),
        now_ns_(now_ns) {}
  [[nodiscard]] std::array<wh_command, 2> divide(const wh_command& command) const noexcept;
  [[nodiscard]] Expected<Done> dropWatchdogs();
  [[nodiscard]] std::uint32_t statusOfBoth() const noexcept;
  [[nodiscard]] bool bothLost() const noexcept { return state_[0].lost && state_[1].lost; }
  [[nodiscard]] bool readPart(std::size_t at) noexcept;
  [[nodiscard]] static bool isOverdue(const PartState& part) noexcept;
  void beginAnew(bool enabled) noexcept;
  [[nodiscard]] std::array<bool, 2> agreeing() noexcept;

  Parts parts_;
  std::vector<wh_axis> axes_;
  std::vector<Place> places_;
  std::int64_t longest_skew_ns_, largest_skew_ns_ = 0;
  std::int64_t (*now_ns_)() noexcept;
  std::array<PartState, 2> state_{};
  bool enabled_ = false;    ///< WH_ENABLE has succeeded
  bool commanded_ = false;  ///< a command was written since
  bool dropped_ = false;    ///< a test by WH_DROP_WATCHDOG is under way
  std::uint64_t samples_ = 0;
};

}  // namespace wholehand
