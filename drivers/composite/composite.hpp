#pragma once

#include "devices/plugin/device_driver.hpp"
#include "drivers/composite/composite_file.hpp"
#include "loop/core/expected.hpp"
#include "loop/core/real_time.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace wholehand {

/// Two devices as one, for example a base and a hand. One thread at a time.
///
/// A part is lost when it gives no sample, when its samples run backwards, or when it refuses a
/// command. Its axes are then invalid and the whole is not enabled, until WH_ENABLE. The loop ramps
/// to neutral, and the healthy part still takes the loop's commands, down to neutral.
class Composite {
 public:
  using Parts = std::array<std::shared_ptr<DeviceDriver>, 2>;

  /// Refused, with the name: an axis that its part does not have.
  [[nodiscard]] static Expected<std::unique_ptr<Composite>> make(const CompositeConfig& config,
                                                                 const Parts& parts);

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
  /// Reads both parts. The whole is enabled and homed when both are; a fault of one part is a fault
  /// of the whole. The time is that of the older sample. When the samples are farther apart than
  /// the file allows, the axes of the older one are invalid. WH_FAILED: both parts are lost.
  /// Real-time safe if both parts are.
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept;
  /// Writes to both parts; axes that the file does not name get no effort. WH_FAILED: both parts
  /// are lost.
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept;

  /// Largest time between the two samples that read() has seen [ns].
  [[nodiscard]] std::int64_t largestSkew_ns() const noexcept { return largest_skew_ns_; }

 private:
  struct Place {
    std::size_t part, axis;  ///< part, and index of the part's axis
  };
  Composite(Parts parts, double longest_skew_s)
      : parts_(std::move(parts)),
        longest_skew_ns_(static_cast<std::int64_t>(longest_skew_s * 1e9)) {}
  [[nodiscard]] std::array<wh_command, 2> divide(const wh_command& command) const noexcept;
  [[nodiscard]] Expected<Done> dropWatchdogs();
  [[nodiscard]] std::uint32_t statusOfBoth() const noexcept;
  [[nodiscard]] bool readPart(std::size_t part) noexcept;
  [[nodiscard]] std::array<bool, 2> agreeing() noexcept;

  Parts parts_;
  std::vector<wh_axis> axes_;
  std::vector<Place> places_;
  std::int64_t longest_skew_ns_, largest_skew_ns_ = 0;
  std::array<bool, 2> lost_{}, begun_{};
  bool dropped_ = false;           ///< a test by WH_DROP_WATCHDOG is under way
  std::array<bool, 2> starved_{};  ///< parts that do not support it: they get no more commands
  std::array<wh_sample, 2> newest_{};
  std::uint64_t samples_ = 0;
};

}  // namespace wholehand
