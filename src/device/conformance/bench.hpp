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

/// How far a driver was brought.
enum class DriverStage {
  kFile,     ///< nothing is loaded
  kLoaded,   ///< the shared object is loaded
  kPlugin,   ///< its wh_plugin can be used
  kOpen,     ///< the device is open and not enabled
  kEnabled,  ///< enabled anew, at neutral, no command yet
};

/// Most of an axis's effort limit that a check sends (but for Does::kOverreaches).
inline constexpr double kEffortShare = 0.2;

/// A sample with room behind it, and what read returned.
struct Sampled {
  int result = WH_FAILED;
  std::int64_t read_ns = 0;  ///< CLOCK_MONOTONIC, after read returned
  wh_sample sample{};
};

/// One driver, called through the bare C functions of device.h: what PluginDriver would refuse or
/// mend shows here. For the process of one group; one thread. Not real-time safe.
class DriverBench {
 public:
  explicit DriverBench(DriverLocation location);
  ~DriverBench();
  DriverBench(const DriverBench&) = delete;
  DriverBench& operator=(const DriverBench&) = delete;

  /// Brings the driver to a stage. Empty: done; else why it cannot be had.
  [[nodiscard]] std::string reach(DriverStage stage);
  /// Neutral and disabled, where it was enabled.
  void calm();

  [[nodiscard]] const DriverLocation& location() const noexcept { return location_; }
  /// From DriverStage::kLoaded on; null without the symbol.
  [[nodiscard]] auto symbol() const noexcept { return symbol_; }
  [[nodiscard]] const std::string& whyNotLoaded() const noexcept { return why_not_loaded_; }
  /// From DriverStage::kPlugin on.
  [[nodiscard]] const wh_plugin& plugin() const noexcept { return *plugin_; }
  [[nodiscard]] bool neverWaits() const noexcept { return (plugin_->flags & WH_NEVER_WAITS) != 0; }
  [[nodiscard]] const wh_host& host() const noexcept { return host_; }
  /// From DriverStage::kOpen on.
  [[nodiscard]] wh_device* device() const noexcept { return device_; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept { return axes_; }

  /// Another device of the same driver. @return its result
  [[nodiscard]] int openAnother(const char* locator, wh_device** device) const;
  /// Closes the device as it is, also enabled, and opens it again. Empty: done.
  [[nodiscard]] std::string reopen();

  [[nodiscard]] int control(std::uint32_t verb) const;
  /// Effort and temperature are NaN before, as for a driver that does not know them.
  [[nodiscard]] Sampled read() const;
  /// With the next sequence. `axes` 0: as many as there are.
  int write(const std::array<double, WH_MAX_AXES>& effort, std::uint32_t axes = 0);
  int writeNeutral();
  /// `share` of the limit on one axis, 0 on the others. @pre |share| <= kEffortShare, or the check
  /// overreaches
  int writeShare(std::size_t axis, double share);
  [[nodiscard]] std::uint64_t sequence() const noexcept { return sequence_; }
  /// Since it was enabled, more than half of the watchdog's time has passed between two commands: a
  /// finding may be this machine's.
  [[nodiscard]] bool stalled() const noexcept;
  void startSequenceAt(std::uint64_t value) noexcept { sequence_ = value; }

  /// Reads once a millisecond. Read once for all the checks of a group.
  [[nodiscard]] const std::vector<Sampled>& samples();
  /// Writes neutral and reads once a millisecond for that long.
  [[nodiscard]] std::vector<Sampled> idle(int milliseconds, bool writing);

  /// What the driver has said, one string a call.
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

/// Once a millisecond of CLOCK_MONOTONIC, until `seconds` are over or it returns false.
void everyMillisecond(double seconds, const std::function<bool()>& step);
/// printf's %.6g.
[[nodiscard]] std::string number(double value);

}  // namespace wholehand
