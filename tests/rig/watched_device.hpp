#pragma once

#include "rig/rig.hpp"
#include "support/rig_tools.hpp"

#include <functional>
#include <limits>

/// A device that records its calls, and a rig with it.
namespace wholehand::test {

inline constexpr const char* kWatchedDevice = "desktop-3axis";

/// The calls that a device received; it outlives the device.
struct Story {
  bool open = false, enabled = false;
  int reads = 0, enables = 0;
  std::function<void()> at_enable = [] {};
};

/// Rests at the origin; from one read on it fails.
class WatchedDevice final : public HapticDevice {
 public:
  explicit WatchedDevice(Story& story, int fails_at = std::numeric_limits<int>::max())
      : story_(story), fails_at_(fails_at) {}
  [[nodiscard]] Expected<Done> open() override {
    story_.open = true;
    return Done{};
  }
  [[nodiscard]] Expected<Done> ready() override { return Done{}; }
  [[nodiscard]] Expected<Done> enable() override {
    story_.at_enable();
    story_.enabled = true;
    ++story_.enables;
    return Done{};
  }
  [[nodiscard]] Fault read(DeviceReading& reading, int) noexcept override {
    reading.q_m = AxisPosition(3);
    return story_.reads++ >= fails_at_ ? Fault::kDeviceRead : Fault::kNone;
  }
  [[nodiscard]] Fault write(const AxisEffort&) noexcept override { return Fault::kNone; }
  void close() noexcept override { story_.open = story_.enabled = false; }

 private:
  Story& story_;
  int fails_at_;
};

inline std::unique_ptr<Rig> watched(Story& story, int fails_at = std::numeric_limits<int>::max(),
                                    const RigOptions& options = {}) {
  return build(load(shippedFiles(kWatchedDevice)), std::make_unique<WatchedDevice>(story, fails_at),
               options);
}

}  // namespace wholehand::test
