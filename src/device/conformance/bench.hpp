#pragma once

#include "device/plugin/plugin_driver.hpp"
#include "wholehand/device.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace wholehand {

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
struct Sampled {
  int result = WH_FAILED;
  std::int64_t read_ns = 0;  ///< CLOCK_MONOTONIC, after read returned
  wh_sample sample{};
};

/// One driver, called through the bare C functions of device.h, so that faults which PluginDriver
/// would refuse or correct are visible. Lives in the process of one group; one thread. Not
/// real-time safe.
class DriverBench {
 public:
  explicit DriverBench(DriverLocation location);
  ~DriverBench();
  DriverBench(const DriverBench&) = delete;
  DriverBench& operator=(const DriverBench&) = delete;

  /// Brings the driver to a stage. Returns why that fails; empty: done.
  [[nodiscard]] std::string reach(DriverStage stage);
  /// Sends neutral and disables, if enabled.
  void calm();

  [[nodiscard]] const DriverLocation& location() const noexcept { return location_; }
  /// From DriverStage::kLoaded on; null where the symbol is missing.
  [[nodiscard]] auto symbol() const noexcept { return symbol_; }
  [[nodiscard]] const std::string& whyNotLoaded() const noexcept { return why_not_loaded_; }
  /// From DriverStage::kPlugin on.
  [[nodiscard]] const wh_plugin& plugin() const noexcept { return *plugin_; }
  [[nodiscard]] bool neverWaits() const noexcept { return (plugin_->flags & WH_NEVER_WAITS) != 0; }
  [[nodiscard]] const wh_host& host() const noexcept { return host_; }
  /// From DriverStage::kOpen on.
  [[nodiscard]] wh_device* device() const noexcept { return device_; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept { return axes_; }

  /// Opens another device of the same driver. @return its result
  [[nodiscard]] int openAnother(const char* locator, wh_device** device) const;
  /// Closes the device, even if enabled, and opens it again. Returns why that fails; empty: done.
  [[nodiscard]] std::string reopen();

  [[nodiscard]] int control(std::uint32_t verb) const;
  /// Reads a sample. Effort and temperature are preset to NaN, for drivers that do not measure
  /// them.
  [[nodiscard]] Sampled read() const;
  /// Writes with the next sequence number. `axes` 0: the number of axes.
  int write(const std::array<double, WH_MAX_AXES>& effort, std::uint32_t axes = 0);
  int writeNeutral();
  /// Writes `share` of the limit on one axis, 0 on the others. @pre |share| <= kEffortShare, or the
  /// check overreaches
  int writeShare(std::size_t axis, double share);
  [[nodiscard]] std::uint64_t sequence() const noexcept { return sequence_; }
  /// Whether more than half of the watchdog's timeout passed between two commands since enabling. A
  /// failed check may then be this machine's fault.
  [[nodiscard]] bool stalled() const noexcept;
  void startSequenceAt(std::uint64_t value) noexcept { sequence_ = value; }

  /// Samples read once a millisecond; taken once for all checks of a group.
  [[nodiscard]] const std::vector<Sampled>& samples();
  /// Reads once a millisecond for that long, and writes neutral if `writing`.
  [[nodiscard]] std::vector<Sampled> idle(int milliseconds, bool writing);

  /// Log lines of the driver, one string a call.
  [[nodiscard]] const std::vector<std::string>& said() const noexcept { return said_; }

 private:
  [[nodiscard]] std::string load();
  [[nodiscard]] std::string takePlugin();
  [[nodiscard]] std::string open();
  [[nodiscard]] std::string enable();
  static void take(void* self, const char* line);

  DriverLocation location_;
  wh_host host_{};
  std::string why_not_loaded_;
  void* library_ = nullptr;
  decltype(&wh_plugin_v1) symbol_ = nullptr;
  const wh_plugin* plugin_ = nullptr;
  wh_device* device_ = nullptr;
  std::vector<wh_axis> axes_;
  std::vector<Sampled> samples_;
  std::vector<std::string> said_;
  std::uint64_t sequence_ = 0;
  std::int64_t written_ns_ = 0, longest_gap_ns_ = 0;
  bool enabled_ = false;
};

/// Calls `step` once a millisecond of CLOCK_MONOTONIC, for `seconds` or until it returns false.
void everyMillisecond(double seconds, const std::function<bool()>& step);
/// The value in printf's %.6g.
[[nodiscard]] std::string number(double value);

}  // namespace wholehand
