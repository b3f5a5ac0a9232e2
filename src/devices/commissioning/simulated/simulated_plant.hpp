#pragma once

#include "devices/plugin/device_driver.hpp"
#include "loop/device/simulated/axis_dynamics.hpp"
#include "loop/model/device_model.hpp"
#include "vocabulary/operator.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace wholehand {

/// The driver's description of a simulated axis: WH_LOCKS, a watchdog of 20 ms.
[[nodiscard]] wh_axis driverAxis(const DeviceAxis& axis, double delay_s);

/// A simulated device that behaves as its file says, with its clock. People learn commissioning on
/// it. Each axis has the file's mass, friction, weight, delay and encoder, stops 1 % beyond its
/// range, a watchdog of 20 ms and an emergency stop. A brake holds it while it is disabled. A tick
/// is one period of simulated time, however long this machine takes. One thread.
class SimulatedPlant final : public DeviceDriver, public TickClock {
 public:
  SimulatedPlant(const DeviceModel& model, double period_s);

  // Overrides of DeviceDriver.
  [[nodiscard]] std::string where() const override { return "the simulated plant"; }
  [[nodiscard]] std::string name() const override { return "simulated plant"; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double argument) override;
  [[nodiscard]] Expected<Done> enable(const wh_command& neutral) override;
  [[nodiscard]] bool enablesAtNeutral() const noexcept override { return true; }
  [[nodiscard]] int read(wh_sample& sample) noexcept override;
  [[nodiscard]] int write(const wh_command& command) noexcept override;

  // Overrides of TickClock; they do not wait.
  void waitForTick() override;
  [[nodiscard]] std::int64_t now_ns() const override { return now_ns_; }

  // Actions of a person. Axes are in the order of the device file.

  /// Moves an axis to a position between its stops [m or rad].
  void place(std::size_t axis, double position);
  /// Pulls an axis with this effort from now on [N or N·m]; 0 ends it.
  void pull(std::size_t axis, double effort) { pulls_[axis] = effort; }
  void pressStop(bool pressed);
  [[nodiscard]] double position(std::size_t axis) const { return plants_[axis].position(); }
  [[nodiscard]] double lowerStop(std::size_t axis) const;
  [[nodiscard]] double upperStop(std::size_t axis) const;

 private:
  void begin(bool enabled, const std::array<double, WH_MAX_AXES>& effort);
  [[nodiscard]] double acting(std::size_t axis) const;

  DeviceModel model_;
  std::int64_t period_ns_;
  std::vector<wh_axis> axes_;
  std::vector<AxisDynamics> plants_;
  std::vector<double> pulls_;
  std::array<double, WH_MAX_AXES> effort_{};                ///< efforts of the last command
  std::deque<std::array<double, WH_MAX_AXES>> on_the_way_;  ///< commands sent but not acting yet
  bool enabled_ = false, fed_ = false, dropped_ = false, silenced_ = false, stop_pressed_ = false;
  std::int64_t now_ns_ = 1'000'000'000;  ///< 0 would mean never
  std::int64_t written_ns_ = 0;
  std::uint64_t samples_ = 0;
};

/// Does by hand, on a simulated device, what a person is asked to do, and reports it. The person
/// still holds the key and answers.
class SimulatedHands final : public Operator {
 public:
  /// @pre person, plant and model outlive this object
  SimulatedHands(Operator& person, SimulatedPlant& plant, const DeviceModel& model)
      : person_(person), plant_(plant), model_(model) {}

  void reportLine(const std::string& line, const std::vector<FoundFigure>& findings) override;
  void reportStep(const StepNews& news) override { person_.reportStep(news); }
  void reportMotion(const Motion& motion, MotionState state) override;
  [[nodiscard]] std::optional<std::string> ask(const Question& question,
                                               const std::function<void()>& meanwhile) override;
  [[nodiscard]] bool holdsKey() override;
  [[nodiscard]] bool gaveUp() override { return person_.gaveUp(); }

 private:
  void act(const Question& question, const std::function<void()>& meanwhile);
  void carry(std::size_t axis, double to, const std::function<void()>& meanwhile);
  void reportSimulated(const std::string& line) { person_.reportLine("Simulated: " + line, {}); }

  Operator& person_;
  SimulatedPlant& plant_;
  const DeviceModel& model_;
  int press_in_ = 0;  ///< queries of the key until the stop is pressed; 0: not requested
};

}  // namespace wholehand
