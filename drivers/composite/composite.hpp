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

/// Two devices as one: a base and a hand, say. One thread at a time.
///
/// A part is lost when it gives no sample, when its samples run backwards, or when it refuses a
/// command. Its axes are then not valid and the whole is not enabled, until WH_ENABLE: the loop
/// ramps to neutral, and the healthy part goes on taking what the loop writes, down to neutral.
class Composite {
 public:
  using Parts = std::array<std::shared_ptr<DeviceDriver>, 2>;

  /// Refused by name: an axis that its part does not have.
  [[nodiscard]] static Expected<std::unique_ptr<Composite>> make(const CompositeConfig& config,
                                                                 const Parts& parts);

  /// Those of the first part, then those of the second, as the file names them.
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept { return axes_; }
  /// Asks both, and is done when both have done it. Where one cannot be enabled, neither stays so.
  /// Of both, "A + B"; no serial number where one has none.
  [[nodiscard]] DriverIdentity identity() const;
  /// WH_DROP_WATCHDOG starves a part that does not know it, and the whole is silenced once both
  /// have let go: one watchdog must not hide that the other is missing.
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument);
  /// As WH_ENABLE, with these efforts from the first moment where both parts can.
  [[nodiscard]] Expected<Done> enable(const wh_command& neutral);
  [[nodiscard]] bool enablesAtNeutral() const noexcept;
  /// Enabled and homed where both are; a fault of one is one of the whole. The time is that of the
  /// older sample. Where the samples are farther apart than the file allows, the axes of the older
  /// one are not valid. WH_FAILED: both are lost. Real-time safe where both parts are.
  [[nodiscard]] WHOLEHAND_RT int read(wh_sample& sample) noexcept;
  /// To both parts; axes that the file does not name get no effort. WH_FAILED: both are lost.
  [[nodiscard]] WHOLEHAND_RT int write(const wh_command& command) noexcept;

  /// The largest that read() has seen [ns].
  [[nodiscard]] std::int64_t largestSkew_ns() const noexcept { return largest_skew_ns_; }

 private:
  struct Place {
    std::size_t part, axis;  ///< which of the part's axes
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
  bool dropped_ = false;           ///< WH_DROP_WATCHDOG is being tried
  std::array<bool, 2> starved_{};  ///< parts that it cannot be said to: they are written to no more
  std::array<wh_sample, 2> newest_{};
  std::uint64_t samples_ = 0;
};

}  // namespace wholehand
