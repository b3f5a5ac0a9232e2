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

/// What a device file knows of an axis that its driver does not say.
struct KnownAxis {
  std::string name;
  double mass = 0.0;            ///< moving mass [kg or kg·m²]
  double neutral_effort = 0.0;  ///< carries the axis's own weight [N or N·m]
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
  DriverBench(DriverLocation location, std::vector<KnownAxis> known);
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

  [[nodiscard]] int control(std::uint32_t verb);
  /// Reads a sample. Effort and temperature are preset to NaN, for drivers that do not measure
  /// them.
  [[nodiscard]] Sampled read() const;
  /// Writes with the next sequence number. `axes` 0: the number of axes.
  int write(const std::array<double, WH_MAX_AXES>& effort, std::uint32_t axes = 0);
  int writeNeutral();
  /// Writes neutral and shares of the limits. @pre |share| <= kEffortShare, or the check
  /// overreaches
  int writeShares(const std::array<double, WH_MAX_AXES>& shares);
  /// The same with a share on one axis alone.
  int writeShare(std::size_t axis, double share);
  /// Effort that carries the axis: of its device file, 0 without one [N or N·m].
  [[nodiscard]] double neutral(std::size_t axis) const;
  /// Moving mass by its device file [kg or kg·m²]; 0: not known.
  [[nodiscard]] double mass(std::size_t axis) const;
  [[nodiscard]] std::uint64_t sequence() const noexcept { return sequence_; }
  /// Whether more than half of the watchdog's timeout passed between two commands since enabling. A
  /// failed check may then be this machine's fault.
  [[nodiscard]] bool stalled() const noexcept;
  /// Shortest time of a watchdog [s]; 1 without any.
  [[nodiscard]] double patience_s() const noexcept;
  /// Stalls so far were judged by the check itself.
  void forgetStalls() noexcept { longest_gap_ns_ = 0; }
  /// The next command comes late on purpose.
  void fallSilent() noexcept { written_ns_ = 0; }
  void startSequenceAt(std::uint64_t value) noexcept { sequence_ = value; }

  /// Samples read once a millisecond; taken once for all checks of a group.
  [[nodiscard]] const std::vector<Sampled>& samples();
  /// How each axis answers to pushes; found once for all checks of a group. @pre it is enabled
  [[nodiscard]] const std::vector<PushedAxis>& pushed();
  void pushAnew() noexcept { pushed_.reset(); }
  /// Reads once a millisecond for that long, and writes neutral if `writing`.
  [[nodiscard]] std::vector<Sampled> idle(int milliseconds, bool writing);

  /// Reports to the waiting process that a long check goes on.
  void alive() const {
    if (on_alive_) on_alive_();
  }
  void onAlive(std::function<void()> tell) { on_alive_ = std::move(tell); }

  /// Log lines of the driver, one string a call.
  [[nodiscard]] const std::vector<std::string>& said() const noexcept { return said_; }

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
  std::vector<Sampled> samples_;
  std::shared_ptr<const std::vector<PushedAxis>> pushed_;
  std::vector<std::string> said_;
  std::function<void()> on_alive_;
  std::uint64_t sequence_ = 0;
  std::int64_t written_ns_ = 0, longest_gap_ns_ = 0;
  bool enabled_ = false;
};

/// Calls `step` once a millisecond of CLOCK_MONOTONIC, for `seconds` or until it returns false.
void everyMillisecond(double seconds, const std::function<bool()>& step);
/// The value in printf's %.6g.
[[nodiscard]] std::string number(double value);

}  // namespace wholehand
