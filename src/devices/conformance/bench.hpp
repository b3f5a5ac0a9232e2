#pragma once

#include "devices/plugin/plugin_driver.hpp"
#include "wholehand/device.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace wholehand {

struct PushedAxis;

/// Facts about an axis from the device file that its driver does not report.
struct KnownAxis {
  std::string name;
  double mass = 0.0;            ///< moving mass [kg or kg·m²]
  double neutral_effort = 0.0;  ///< balances the axis's own weight [N or N·m]
};

/// Stage that a driver has reached.
enum class DriverStage {
  kFile,     ///< nothing is loaded
  kLoaded,   ///< the shared object is loaded
  kPlugin,   ///< its wh_plugin is usable
  kOpen,     ///< the device is open and not enabled
  kEnabled,  ///< freshly enabled, at neutral, no command yet
};

/// Largest share of an axis's effort limit that a check sends (except Effect::kOverreaches).
inline constexpr double kEffortShare = 0.2;

/// A sample, and the result of its read.
struct SampleRead {
  int result = WH_FAILED;
  std::int64_t read_ns = 0;  ///< CLOCK_MONOTONIC, after read() returned
  wh_sample sample{};
};

/// One driver, called directly through the C functions of device.h, so that faults which
/// PluginDriver would refuse or correct are visible. Each group of checks has one in its own
/// process; one thread. Not real-time safe.
class DriverBench {
 public:
  DriverBench(DriverLocation location, std::vector<KnownAxis> known);
  ~DriverBench();
  DriverBench(const DriverBench&) = delete;
  DriverBench& operator=(const DriverBench&) = delete;

  /// Brings the driver to a stage. Returns why that fails; empty: success.
  [[nodiscard]] std::string reach(DriverStage stage);
  /// Sends neutral and disables the device if it is enabled.
  void disableAtNeutral();

  [[nodiscard]] const DriverLocation& location() const noexcept { return location_; }
  /// Valid from DriverStage::kLoaded on; null if the symbol is missing.
  [[nodiscard]] auto symbol() const noexcept { return symbol_; }
  [[nodiscard]] const std::string& whyNotLoaded() const noexcept { return why_not_loaded_; }
  /// Valid from DriverStage::kPlugin on.
  [[nodiscard]] const wh_plugin& plugin() const noexcept { return *plugin_; }
  [[nodiscard]] bool neverWaits() const noexcept { return (plugin_->flags & WH_NEVER_WAITS) != 0; }
  [[nodiscard]] const wh_host& host() const noexcept { return host_; }
  /// Valid from DriverStage::kOpen on.
  [[nodiscard]] wh_device* device() const noexcept { return device_; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept { return axes_; }

  /// Opens another device of the same driver. @return its result
  [[nodiscard]] int openAnother(const char* locator, wh_device** device) const;
  /// Closes the device, even if enabled, and opens it again. Returns why that fails; empty:
  /// success.
  [[nodiscard]] std::string reopen();

  [[nodiscard]] int control(std::uint32_t verb);
  /// Reads a sample. Effort and temperature are preset to NaN, for drivers that do not measure
  /// them.
  [[nodiscard]] SampleRead read() const;
  /// Writes a command with the next sequence number. `axes` 0: the number of axes.
  int write(const std::array<double, WH_MAX_AXES>& effort, std::uint32_t axes = 0);
  int writeNeutral();
  /// Writes neutral plus shares of the limits. @pre |share| <= kEffortShare, or the check
  /// overreaches
  int writeShares(const std::array<double, WH_MAX_AXES>& shares);
  /// Writes neutral plus a share of the limit on one axis.
  int writeShare(std::size_t axis, double share);
  /// Effort that balances the axis, from its device file; 0 without one [N or N·m].
  [[nodiscard]] double neutral(std::size_t axis) const;
  /// Moving mass from the device file [kg or kg·m²]; 0: unknown.
  [[nodiscard]] double mass(std::size_t axis) const;
  [[nodiscard]] std::uint64_t sequence() const noexcept { return sequence_; }
  /// True when more than half of the watchdog's timeout passed between two commands since enabling.
  /// A failure of a check may then be caused by this machine.
  [[nodiscard]] bool stalled() const noexcept;
  /// Shortest timeout of a watchdog [s]; 1 without any watchdog.
  [[nodiscard]] double patience_s() const noexcept;
  /// Resets the longest gap, for a check that has handled stalls itself.
  void forgetStalls() noexcept { longest_gap_ns_ = 0; }
  /// Excludes the next gap from stalled(): the next command is late on purpose.
  void fallSilent() noexcept { written_ns_ = 0; }
  void startSequenceAt(std::uint64_t value) noexcept { sequence_ = value; }

  /// Samples read once a millisecond; measured once for all checks of a group.
  [[nodiscard]] const std::vector<SampleRead>& samples();
  /// Response of each axis to pushes; measured once for all checks of a group. @pre the device is
  /// enabled
  [[nodiscard]] const std::vector<PushedAxis>& pushed();
  void pushAnew() noexcept { pushed_.reset(); }
  /// Reads once a millisecond for that time, and also writes neutral if `writing`.
  [[nodiscard]] std::vector<SampleRead> idle(int milliseconds, bool writing);

  /// Tells the waiting parent process that a long check continues.
  void alive() const {
    if (on_alive_) on_alive_();
  }
  void onAlive(std::function<void()> report) { on_alive_ = std::move(report); }

  /// Log lines of the driver, one string per call.
  [[nodiscard]] const std::vector<std::string>& hostLines() const noexcept { return host_lines_; }

 private:
  [[nodiscard]] std::string load();
  [[nodiscard]] std::string takePlugin();
  [[nodiscard]] std::string open();
  [[nodiscard]] std::string enable();
  static void take(void* self, const char* line);

  [[nodiscard]] const KnownAxis* known(std::size_t axis) const;

  DriverLocation location_;
  std::vector<KnownAxis> known_;
  wh_host host_{};
  std::string why_not_loaded_;
  void* library_ = nullptr;
  decltype(&wh_plugin_v1) symbol_ = nullptr;
  const wh_plugin* plugin_ = nullptr;
  wh_device* device_ = nullptr;
  std::vector<wh_axis> axes_;
  std::vector<SampleRead> samples_;
  std::shared_ptr<const std::vector<PushedAxis>> pushed_;
  std::vector<std::string> host_lines_;
  std::function<void()> on_alive_;
  std::uint64_t sequence_ = 0;
  std::int64_t written_ns_ = 0, longest_gap_ns_ = 0;
  bool enabled_ = false;
};

/// Calls `step` once a millisecond of CLOCK_MONOTONIC, for `seconds` or until it returns false.
void everyMillisecond(double seconds, const std::function<bool()>& step);
/// Formats a value like printf's %.6g.
[[nodiscard]] std::string number(double value);

}  // namespace wholehand
