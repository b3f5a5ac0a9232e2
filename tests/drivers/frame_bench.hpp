#pragma once

#include "devices/plugin/device_driver.hpp"
#include "drivers/frame/firmware/firmware.h"
#include "drivers/frame/frame_device.hpp"
#include "support/figure.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// The reference firmware and the program's side on one simulated clock; a test can cut and corrupt
/// the line between them. No threads.
namespace wholehand::test {

using Line = std::deque<std::uint8_t>;

/// The two directions of a line: the program writes one, the device the other.
struct Wires {
  Line to_device, from_device;
  bool gone = false;
};

class MemoryCarrier final : public Carrier {
 public:
  explicit MemoryCarrier(std::shared_ptr<Wires> wires) : wires_(std::move(wires)) {}
  [[nodiscard]] bool send(const std::uint8_t* bytes, std::size_t count) noexcept override {
    wires_->to_device.insert(wires_->to_device.end(), bytes, bytes + count);
    return !wires_->gone;
  }
  [[nodiscard]] int receive(std::uint8_t* bytes, std::size_t capacity) noexcept override {
    Line& line = wires_->from_device;
    if (wires_->gone) return -1;
    const std::size_t count = std::min(capacity, line.size());
    std::copy_n(line.begin(), count, bytes);
    line.erase(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(count));
    return static_cast<int>(count);
  }
  [[nodiscard]] int descriptor() const noexcept override { return -1; }

 private:
  std::shared_ptr<Wires> wires_;
};

/// A board whose positions a test sets and whose efforts it reads.
class BenchBoard {
 public:
  explicit BenchBoard(int axes = 3) : wires(std::make_shared<Wires>()) {
    static constexpr std::array<const char*, 6> kNames = {"x", "y", "z", "roll", "pitch", "yaw"};
    board.context = this;
    std::strcpy(board.name, "bench");
    board.axes = static_cast<std::uint8_t>(axes);
    board.silence_us = 20'000;
    for (int i = 0; i < axes; ++i) {
      wf_axis& axis = board.axis[i];
      std::strcpy(axis.name, kNames.at(static_cast<std::size_t>(i)));
      axis.kind = i < 3 ? WH_TRANSLATION : WH_ROTATION;
      axis.lower = -0.1F, axis.upper = 0.1F;
      axis.effort_limit = 8.0F;
      axis.resolution = 2e-5F;
      axis.delay_s = 0.0005F;
      axis.silence_s = 0.02F;
    }
    board.measure = [](void* self, fw_state* to) { *to = static_cast<BenchBoard*>(self)->state; };
    board.drive = [](void* self, const float* effort, int enabled) {
      auto& bench = *static_cast<BenchBoard*>(self);
      std::copy_n(effort, WF_MAX_AXES, bench.given.begin());
      bench.on = enabled != 0;
    };
    board.control = [](void* self, std::uint8_t verb, float) -> std::int32_t {
      static_cast<BenchBoard*>(self)->verbs.push_back(verb);
      return verb == WH_IDENTIFY ? WH_OK : WH_UNSUPPORTED;
    };
    board.send = [](void* self, const std::uint8_t* bytes, std::size_t count) {
      Line& line = static_cast<BenchBoard*>(self)->wires->from_device;
      line.insert(line.end(), bytes, bytes + count);
    };
    state.status = WH_HOMED;
    state.valid = (1U << static_cast<unsigned>(axes)) - 1U;
    firmware_init(&fw, &board);
  }
  BenchBoard(const BenchBoard&) = delete;
  BenchBoard& operator=(const BenchBoard&) = delete;

  /// The firmware receives the bytes that have arrived.
  void receiveAll() {
    const std::vector<std::uint8_t> bytes(wires->to_device.begin(), wires->to_device.end());
    wires->to_device.clear();
    firmware_receive(&fw, bytes.data(), bytes.size(), now_us);
  }
  /// The firmware receives the bytes and ticks once.
  void tick() {
    receiveAll();
    firmware_tick(&fw, now_us);
  }
  /// Lets 1 ms pass with a tick of the firmware.
  void pass() {
    now_us += 1000;
    tick();
  }
  void pass(int ticks) {
    for (int i = 0; i < ticks; ++i) pass();
  }
  [[nodiscard]] std::int64_t now_ns() const { return std::int64_t{now_us} * 1000; }
  [[nodiscard]] FrameDevice::Wait wait() {
    return [this] {
      if (!silent) pass();
      if (silent) now_us += 1000;
      return now_ns();
    };
  }
  [[nodiscard]] Expected<std::unique_ptr<FrameDevice>> open(std::uint32_t session = 5) {
    return FrameDevice::open(std::make_unique<MemoryCarrier>(wires), session, wait());
  }

  std::shared_ptr<Wires> wires;
  fw_board board{};
  firmware fw{};
  fw_state state{};
  std::array<float, WF_MAX_AXES> given{};
  bool on = false;
  bool silent = false;  ///< the board is switched off
  std::vector<int> verbs;
  std::uint32_t now_us = 1000;
};

inline wh_command commandOf(std::vector<double> efforts, std::uint64_t sequence = 1) {
  wh_command command{};
  command.size = sizeof(command);
  command.axes = static_cast<std::uint32_t>(efforts.size());
  command.sequence = sequence;
  std::copy(efforts.begin(), efforts.end(), command.effort);
  return command;
}

inline wh_sample emptySample() {
  wh_sample sample{};
  sample.size = sizeof(sample);
  return sample;
}

/// Adapts a FrameDevice to the driver interface of a PluginDevice.
class BenchDriver : public DeviceDriver {
 public:
  explicit BenchDriver(BenchBoard& bench) : bench_(bench), frame_(orThrow(bench.open())) {}
  [[nodiscard]] std::string where() const override { return "the frame of the test"; }
  [[nodiscard]] std::string name() const override { return frame_->name(); }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override {
    return frame_->axes();
  }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override {
    return frame_->control(verb, argument, bench_.wait());
  }
  [[nodiscard]] int read(wh_sample& sample) noexcept override { return frame_->read(sample); }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    return frame_->write(command);
  }
  void pump() { frame_->pump(bench_.now_ns()); }

 private:
  BenchBoard& bench_;
  std::unique_ptr<FrameDevice> frame_;
};

}  // namespace wholehand::test
