#pragma once

#include "moteus/bus_clock.hpp"
#include "moteus/can_bus.hpp"

#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Fake drives with moteus's register protocol, written from its documentation and independent of
/// the driver, so that the two check each other.
namespace wholehand::test {

class FakeDrive {
 public:
  explicit FakeDrive(int id) : id_(id) {}

  int mode = 0, fault = 0, home = 2;
  double position_rev = 0.0;
  bool answers = true;
  double temperature_c = 25.0;
  double serial_word = 7.0;  ///< second of the three words of its serial number
  int firmware = 0x0100;
  std::int64_t enabling_ns = 10'000'000;  ///< time from the first command to position mode
  std::map<std::string, std::string> conf = {{"servo.default_timeout_s", "0.100000"},
                                             {"servo.timeout_mode", "12"},
                                             {"servo.timeout_max_torque_Nm", "0.200000"},
                                             {"servo.fixed_voltage_mode", "0"},
                                             {"servo.inertia_feedforward", "0.000000"}};
  int commands = 0;  ///< number of frames with a command

  [[nodiscard]] int id() const { return id_; }
  /// Torque at the output [N.m]: the commanded torque, plus an error if gains were left on.
  [[nodiscard]] double torque_nm() const;
  /// Advances its watchdog by its own clock.
  void advance(std::int64_t now_ns);
  /// Processes a frame and answers if asked to.
  std::optional<std::vector<std::uint8_t>> take(const std::vector<std::uint8_t>& data, bool reply,
                                                std::int64_t now_ns);
  /// Restarts it as after a short loss of power.
  void restart();

 private:
  struct Command {
    double position = 0.0, torque_nm = 0.0, kp_scale = 1.0, kd_scale = 1.0, integral_scale = 1.0;
    double most_nm = std::numeric_limits<double>::quiet_NaN(), watchdog_s = 0.0;
  };
  void write(std::uint32_t reg, double value, int& wanted_mode, Command& command);
  void read(std::uint32_t first, std::uint32_t count, int type, std::vector<std::uint8_t>& out);
  void apply(int wanted_mode, const Command& command, std::int64_t now_ns);
  void receive(const std::string& text);
  [[nodiscard]] double valueOf(std::uint32_t reg) const;

  int id_;
  Command command_;
  std::int64_t fed_ns_ = 0, enabled_ns_ = 0;
  std::string received_, answer_;
};

/// Simulated time, advanced only by the test or the driver's rest().
struct SimulatedTime {
  std::int64_t now_ns = 1'000'000'000;
};

class SimulatedClock final : public moteus::BusClock {
 public:
  explicit SimulatedClock(SimulatedTime& time) : time_(time) {}
  [[nodiscard]] std::int64_t now_ns() noexcept override { return time_.now_ns; }
  void rest() override { time_.now_ns += 100'000; }

 private:
  SimulatedTime& time_;
};

/// State of a test's bus; it outlives the driver.
struct FakeBusState {
  std::vector<FakeDrive> drives;
  std::int64_t latency_ns = 200'000;  ///< time from a command to its answer
  bool by_hand = false;               ///< frames reach the drives by deliver() only
  bool unplugged = false;
  int loses_from = 0,
      loses = 0;  ///< first and number of the frames that reach no drive, counted by `frames`
  std::deque<std::pair<std::int64_t, moteus::CanFrame>> sent;
  std::deque<std::pair<std::int64_t, moteus::CanFrame>> answers;
  int frames = 0;

  /// Delivers all frames sent until now to the drives.
  void deliver(std::int64_t now_ns);
  /// Puts a frame of another sender on the bus.
  void inject(std::uint32_t id, const std::vector<std::uint8_t>& data, std::int64_t now_ns);
};

class FakeBus final : public moteus::CanBus {
 public:
  FakeBus(FakeBusState& state, SimulatedTime& time) : state_(state), time_(time) {}
  [[nodiscard]] moteus::BusResult send(const moteus::CanFrame& frame) noexcept override;
  [[nodiscard]] moteus::BusResult receive(moteus::CanFrame& frame) noexcept override;
  [[nodiscard]] std::uint64_t errors() const noexcept override { return 0; }

 private:
  FakeBusState& state_;
  SimulatedTime& time_;
};

}  // namespace wholehand::test
