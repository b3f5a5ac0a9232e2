#pragma once

#include "devices/commissioning/simulated/simulated_plant.hpp"
#include "devices/plugin/device_driver.hpp"
#include "loop/model/device_model.hpp"
#include "mechanism.hpp"
#include "vocabulary/operator.hpp"

#include <cstring>
#include <functional>
#include <string>

namespace wholehand::test {

/// Faults that a test can inject into a device.
struct InjectedFaults {
  std::string axis;  ///< axis with the fault
  bool encoder_sign = false, motor_sign = false, wraps = false;
  double scale = 1.0;               ///< factor on its position
  double effort_scale = 1.0;        ///< factor on its effort
  std::string swapped_with;         ///< axis with which it exchanges the motor
  std::string encoder_of;           ///< axis with which it exchanges the encoder
  double homed_off = 0.0;           ///< error of its homed position [share of its range]
  double hidden_weight = 0.0;       ///< weight not stated in its file [share of its effort limit]
  bool stop_says_silenced = false;  ///< not enabled once its watchdog let go
  bool deaf_home = false;           ///< WH_HOME fails
  bool watchdog_bit = false,
       stop_bit = false;  ///< only the status bit changes
  bool no_watchdog = false, no_stop_button = false, anonymous = false, cannot_drop = false;
};

/// A fake driver with its device: a Mechanism on a simulated clock, with a watchdog and an
/// emergency stop. Its axes are those of the device file, in another order.
class FakeDevice final : public DeviceDriver, public TickClock {
 public:
  Mechanism mechanism;
  bool stop_pressed = false;
  bool frozen = false;            ///< samples do not change
  std::vector<double> acting;     ///< effort of each motor in the last period [N or N·m]
  std::int64_t late_ns = 0;       ///< delay of the next tick; the mechanism advances by one period
  std::function<void()> on_tick;  ///< called after each tick
  std::function<std::int64_t(std::int64_t)> shown_ns;  ///< reported time of a sample

  FakeDevice(const DeviceModel& model, InjectedFaults injected, double period_s = 1e-3)
      : mechanism(mechanismOf(model, injected), period_s),
        model_(model),
        injected_(std::move(injected)),
        period_s_(period_s) {
    if (!injected_.anonymous) identity_ = {"F-1", "3.1", "0.9", ""};
    const std::size_t n = model.axes.size();
    for (std::size_t i = 0; i < n; ++i) order_.push_back(n - 1 - i);
    for (const std::size_t i : order_) {
      axes_.push_back(driverAxis(model.axes[i], 1e-3));
      axes_.back().disabled = 0;
    }
    sent_.assign(n, 0.0);
    mechanism.pushed.assign(n, 0.0);
  }

  // Implements DeviceDriver.
  [[nodiscard]] std::string where() const override { return "the fake device"; }
  [[nodiscard]] std::string name() const override { return "fake"; }
  [[nodiscard]] const std::vector<wh_axis>& axes() const noexcept override { return axes_; }
  [[nodiscard]] Expected<Done> control(std::uint32_t verb, double) override {
    if (verb == WH_HOME && injected_.deaf_home) {
      return fileFault("", "the device did not be homed", "look at it");
    }
    if (verb == WH_ENABLE && stop_pressed) {
      return fileFault("", "the emergency stop is pressed", "release it");
    }
    if (verb == WH_ENABLE || verb == WH_DISABLE) {
      enabled_ = verb == WH_ENABLE;
      silent_s_ = -1.0;
      dropped_ = silenced_ = cut_ = false;
      sent_.assign(sent_.size(), 0.0);
    }
    if (verb == WH_DROP_WATCHDOG) {
      if (injected_.cannot_drop) return fileFault("", "cannot", "");
      dropped_ = true;
      silent_s_ = 0.0;
    }
    return Done{};
  }
  [[nodiscard]] int read(wh_sample& sample) noexcept override {
    if (frozen && samples_ > 0) {
      sample = last_;
      return WH_NOTHING_NEW;
    }
    sample = {};
    sample.status = WH_HOMED;
    const bool off = silenced_ && injected_.stop_says_silenced;
    if (enabled_ && !off) sample.status |= WH_ENABLED;
    if (silenced_) sample.status |= WH_SILENCED;
    sample.sequence = ++samples_;
    sample.monotonic_ns = shown_ns ? shown_ns(now_) : now_;
    sample.valid = (1U << order_.size()) - 1U;
    for (std::size_t d = 0; d < order_.size(); ++d) sample.position[d] = shown(order_[d]);
    last_ = sample;
    return WH_OK;
  }
  [[nodiscard]] int write(const wh_command& command) noexcept override {
    if (!enabled_ && !(cut_ && injected_.stop_bit)) return WH_FAILED;
    if (silenced_) return WH_OK;
    if (!dropped_) silent_s_ = 0.0;
    for (std::size_t d = 0; d < order_.size(); ++d) sent_[order_[d]] = command.effort[d];
    return WH_OK;
  }

  // Implements TickClock.
  void waitForTick() override {
    now_ += std::llround(1e9 * period_s_) + std::exchange(late_ns, 0);
    if (stop_pressed && enabled_ && !injected_.no_stop_button) {
      enabled_ = false;
      cut_ = true;
      if (!injected_.stop_bit) sent_.assign(sent_.size(), 0.0);
    }
    if (silent_s_ >= 0.0) silent_s_ += period_s_;
    if (silent_s_ > 0.02 && !injected_.no_watchdog) silenced_ = true;
    acting.assign(sent_.size(), 0.0);
    for (std::size_t i = 0; i < sent_.size(); ++i) {
      const DeviceAxis& a = model_.axes[i];
      const bool it = a.name == injected_.axis;
      const bool bit_only =
          it && ((silenced_ && injected_.watchdog_bit) || (cut_ && injected_.stop_bit));
      if ((!enabled_ || silenced_) && !bit_only) continue;
      std::size_t to = i;
      if (it && !injected_.swapped_with.empty()) to = indexOf(injected_.swapped_with);
      if (a.name == injected_.swapped_with) to = indexOf(injected_.axis);
      const double share = sent_[i] / a.effort_limit * model_.axes[to].effort_limit;
      acting[to] =
          share * (it ? injected_.effort_scale * (injected_.motor_sign ? -1.0 : 1.0) : 1.0);
    }
    mechanism.advance(acting);
    if (on_tick) on_tick();
  }
  [[nodiscard]] std::int64_t now_ns() const override { return now_; }

  [[nodiscard]] bool enabled() const { return enabled_; }
  [[nodiscard]] std::size_t indexOf(const std::string& axis) const {
    return static_cast<std::size_t>(model_.axisIndex(axis));
  }

 private:
  [[nodiscard]] static std::vector<MechanismAxis> mechanismOf(const DeviceModel& model,
                                                              const InjectedFaults& injected) {
    std::vector<MechanismAxis> out;
    for (const DeviceAxis& a : model.axes) {
      MechanismAxis m;
      m.mass = a.mass;
      m.damping = a.damping;
      m.coulomb = a.coulomb;
      m.gravity = a.neutral_effort;
      if (a.name == injected.axis) m.gravity += injected.hidden_weight * a.effort_limit;
      m.lower = a.lower - 0.01 * (a.upper - a.lower);
      m.upper = a.upper + 0.01 * (a.upper - a.lower);
      m.step = a.encoder_step;
      m.delay_s = model.output_delay_ticks * 1e-3;
      out.push_back(m);
    }
    return out;
  }
  [[nodiscard]] double shown(std::size_t i) const noexcept {
    const std::string& name = model_.axes[i].name;
    if (!injected_.encoder_of.empty()) {
      if (name == injected_.axis) return mechanism.position(indexOf(injected_.encoder_of));
      if (name == injected_.encoder_of) return mechanism.position(indexOf(injected_.axis));
    }
    double q = mechanism.position(i);
    const DeviceAxis& a = model_.axes[i];
    if (a.name != injected_.axis) return q;
    q += injected_.homed_off * (a.upper - a.lower);
    const double middle = 0.5 * (a.lower + a.upper), turn = 0.6 * (a.upper - a.lower);
    q = middle + injected_.scale * (injected_.encoder_sign ? -1.0 : 1.0) * (q - middle);
    if (injected_.wraps) q = middle + std::remainder(q - middle, turn);
    return q;
  }

  DeviceModel model_;
  InjectedFaults injected_;
  double period_s_;

  std::vector<std::size_t> order_;  ///< axis of the driver → axis of the file
  std::vector<wh_axis> axes_;
  std::vector<double> sent_;
  bool enabled_ = false, dropped_ = false, silenced_ = false, cut_ = false;
  double silent_s_ = -1.0;
  std::int64_t now_ = 1'000'000;
  std::uint64_t samples_ = 0;
  wh_sample last_{};
};

/// An operator that does what it is asked to: pushes axes, measures distances, hangs weights and
/// presses the stop. Counts its actions: answers, and every press of the key for a step without a
/// question.
class ScriptedOperator final : public Operator {
 public:
  ScriptedOperator(FakeDevice& device, const DeviceModel& model) : device_(device), model_(model) {}

  void reportLine(const std::string& line, const std::vector<FoundFigure>&) override {
    said += line + "\n";
    if (line.find("Take the weight off") == std::string::npos) return;
    for (double& pull : device_.mechanism.pushed) pull = 0.0;
  }
  void reportStep(const StepNews& news) override { steps.push_back(news); }
  void reportMotion(const Motion& motion, MotionState state) override {
    const bool presses = motion.what == MotionKind::kEmergencyStop && state == MotionState::kMoves;
    press_in_ = presses ? 100 : 0;
  }
  [[nodiscard]] std::optional<std::string> ask(const Question& asked_now,
                                               const std::function<void()>& meanwhile) override {
    const std::string& question = asked_now.text;
    ++actions;
    asked += question + "\n";
    const auto look = [&] {
      device_.waitForTick();
      meanwhile();
    };
    look();
    if (question.find("serial number") != std::string::npos) return "yes";
    if (question.find("NOBODY") != std::string::npos) {
      for (std::size_t i = 0; i < model_.axes.size(); ++i) {
        const DeviceAxis& a = model_.axes[i];
        device_.mechanism.place(i, 0.5 * (a.lower + a.upper) + off_mark);
      }
      look();
      return nobody ? "yes" : "no";
    }
    if (asked_now.about == QuestionKind::kEmergencyStop) {
      device_.stop_pressed = false;
      return "";
    }
    const std::size_t axis = axisOf(question);
    const DeviceAxis& a = model_.axes[axis];
    const double range = a.upper - a.lower;
    if (question.rfind("Push", 0) == 0) {
      move(axis, device_.mechanism.true_position(axis) + 0.12 * range, look);
      return "";
    }
    if (question.rfind("Move", 0) == 0) {
      move(axis, a.lower - 0.01 * range, look);
      move(axis, a.upper + 0.01 * range, look);
      return std::to_string(1.02 * range);
    }
    for (double& pull : device_.mechanism.pushed) pull = 0.0;
    const double force = 0.05 * a.effort_limit;
    device_.mechanism.pushed[axis] = -force;
    return std::to_string(force);
  }
  [[nodiscard]] bool holdsKey() override {
    ++looks;
    if (on_look) on_look();
    if (press_in_ > 0 && --press_in_ == 0) pressStop();
    return looks <= lets_go_after;
  }
  [[nodiscard]] bool gaveUp() override { return gave_up; }

  bool nobody = true, gave_up = false;
  bool presses_stop = true;
  int late_ticks = 0;     ///< ticks for which the program stalls before the stop is pressed
  double off_mark = 0.0;  ///< distance of the device from its mark [m or rad]
  int actions = 0;
  long looks = 0, lets_go_after = 1L << 60;
  std::function<void()> on_look;  ///< called at each look at the key
  std::string said, asked;
  std::vector<StepNews> steps;

 private:
  [[nodiscard]] std::size_t axisOf(const std::string& question) const {
    const std::size_t at = question.find("axis ") + 5;
    return device_.indexOf(question.substr(at, question.find(' ', at) - at));
  }
  // Moves the axis by hand within a second, without resistance.
  template <class Look>
  void move(std::size_t axis, double to, const Look& look) {
    const double from = device_.mechanism.true_position(axis);
    for (int i = 1; i <= 1000; ++i) {
      device_.mechanism.place(axis, from + (to - from) * i / 1000.0);
      look();
    }
  }
  void pressStop() {
    for (int i = 0; i < late_ticks; ++i) device_.waitForTick();
    device_.stop_pressed = presses_stop;
  }

  FakeDevice& device_;
  const DeviceModel& model_;
  int press_in_ = 0;  ///< looks at the key until the stop is pressed; 0: never
};

}  // namespace wholehand::test
