#include "devices/commissioning/simulated/simulated_plant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace wholehand {
namespace {

constexpr double kBeyondRange = 0.01;  // distance of the stops beyond the range, as a share of it
constexpr double kSilence_s = 0.02;
constexpr int kByHand_ticks = 1000;   // duration of a motion by hand
constexpr double kPushed = 0.12;      // length of a push by hand, as a share of the range
constexpr double kRulerReads = 1e-3;  // resolution of the ruler, as a share of the measured length
constexpr int kPressAfter_looks = 500;

double beyond(const DeviceAxis& axis) {
  return kBeyondRange * (axis.upper - axis.lower);
}

}  // namespace

wh_axis driverAxis(const DeviceAxis& axis, double delay_s) {
  wh_axis out{};
  out.size = sizeof out;
  std::strncpy(out.name, axis.name.c_str(), sizeof out.name - 1);
  out.kind = axis.kind == AxisKind::kRotation ? WH_ROTATION : WH_TRANSLATION;
  out.effort_meaning = WH_EFFORT;
  out.lower = axis.lower;
  out.upper = axis.upper;
  out.effort_limit = axis.effort_limit;
  out.resolution = axis.encoder_step;
  out.delay_s = delay_s;
  out.silence_s = kSilence_s;
  out.disabled = WH_LOCKS;
  return out;
}

SimulatedPlant::SimulatedPlant(const DeviceModel& model, double period_s)
    : model_(model), period_ns_(std::llround(1e9 * period_s)), pulls_(model.axes.size(), 0.0) {
  identity_ = {"simulated", "simulated", "", "", true};
  for (const DeviceAxis& axis : model_.axes) {
    axes_.push_back(driverAxis(axis, model.output_delay_ticks * period_s));
    AxisPlant plant;
    plant.mass = axis.mass;
    plant.damping = axis.damping;
    plant.coulomb = axis.coulomb;
    plant.lower = axis.lower - beyond(axis);
    plant.upper = axis.upper + beyond(axis);
    plants_.emplace_back(plant, period_s);
    plants_.back().place(0.5 * (axis.lower + axis.upper), 0.0);
  }
  on_the_way_.resize(static_cast<std::size_t>(model.output_delay_ticks));
}

double SimulatedPlant::lowerStop(std::size_t axis) const {
  return model_.axes[axis].lower - beyond(model_.axes[axis]);
}

double SimulatedPlant::upperStop(std::size_t axis) const {
  return model_.axes[axis].upper + beyond(model_.axes[axis]);
}

void SimulatedPlant::begin(bool enabled, const std::array<double, WH_MAX_AXES>& effort) {
  enabled_ = enabled;
  fed_ = dropped_ = silenced_ = false;
  effort_ = effort;
  std::fill(on_the_way_.begin(), on_the_way_.end(), effort);
}

Expected<Done> SimulatedPlant::control(std::uint32_t verb, double /*argument*/) {
  switch (verb) {
    case WH_ENABLE:
      if (stop_pressed_) {
        return fileFault("", "the emergency stop is pressed", "release it");
      }
      begin(true, {});
      return Done{};
    case WH_DISABLE:
      begin(false, {});
      return Done{};
    case WH_DROP_WATCHDOG:
      dropped_ = true;
      return Done{};
    default:
      return Done{};
  }
}

Expected<Done> SimulatedPlant::enable(const wh_command& neutral) {
  if (auto done = control(WH_ENABLE, 0.0); !done) return done;
  std::array<double, WH_MAX_AXES> effort{};
  std::copy_n(neutral.effort, axes_.size(), effort.begin());
  begin(true, effort);
  return Done{};
}

int SimulatedPlant::read(wh_sample& sample) noexcept {
  sample = {};
  sample.size = sizeof sample;
  sample.status = WH_HOMED;
  if (enabled_) sample.status |= WH_ENABLED;
  if (silenced_) sample.status |= WH_SILENCED;
  sample.sequence = ++samples_;
  sample.monotonic_ns = now_ns_;
  sample.valid = (1U << axes_.size()) - 1U;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const double step = model_.axes[i].encoder_step;
    const double at = plants_[i].position();
    sample.position[i] = step > 0.0 ? std::round(at / step) * step : at;
    sample.effort[i] = sample.temperature_c[i] = std::nan("");
  }
  return WH_OK;
}

int SimulatedPlant::write(const wh_command& command) noexcept {
  if (!enabled_) return WH_FAILED;
  if (!dropped_) written_ns_ = now_ns_;
  fed_ = true;
  std::copy_n(command.effort, axes_.size(), effort_.begin());
  return WH_OK;
}

double SimulatedPlant::acting(std::size_t axis) const {
  const double sent = on_the_way_.empty() ? effort_[axis] : on_the_way_.front()[axis];
  const double limit = model_.axes[axis].effort_limit;
  return std::clamp(sent, -limit, limit) - model_.axes[axis].neutral_effort + pulls_[axis];
}

void SimulatedPlant::waitForTick() {
  now_ns_ += period_ns_;
  const auto silence_ns = static_cast<std::int64_t>(1e9 * kSilence_s);
  if (enabled_ && fed_ && now_ns_ - written_ns_ > silence_ns) silenced_ = true;
  const bool held = !enabled_ || silenced_;  // the brake holds it
  for (std::size_t i = 0; i < plants_.size(); ++i) {
    if (held) {
      plants_[i].place(plants_[i].position(), 0.0);
    } else {
      plants_[i].advance({acting(i), acting(i)});
    }
  }
  if (on_the_way_.empty()) return;
  on_the_way_.pop_front();
  on_the_way_.push_back(effort_);
}

void SimulatedPlant::place(std::size_t axis, double position) {
  plants_[axis].place(position, 0.0);
}

void SimulatedPlant::pressStop(bool pressed) {
  stop_pressed_ = pressed;
  if (pressed) begin(false, {});
}

void SimulatedHands::reportLine(const std::string& line, const std::vector<FoundFigure>& findings) {
  person_.reportLine(line, findings);
  if (line.find("Take the weight off") == std::string::npos) return;
  for (std::size_t i = 0; i < model_.axes.size(); ++i) plant_.pull(i, 0.0);
  reportSimulated("the weight is off.");
}

void SimulatedHands::reportMotion(const Motion& motion, MotionState state) {
  person_.reportMotion(motion, state);
  const bool presses = motion.what == MotionKind::kEmergencyStop && state == MotionState::kMoves;
  press_in_ = presses ? kPressAfter_looks : 0;
}

bool SimulatedHands::holdsKey() {
  if (!person_.holdsKey()) return false;
  if (press_in_ > 0 && --press_in_ == 0) {
    plant_.pressStop(true);
    reportSimulated("the emergency stop is pressed.");
  }
  return true;
}

std::optional<std::string> SimulatedHands::ask(const Question& question,
                                               const std::function<void()>& meanwhile) {
  act(question, meanwhile);
  return person_.ask(question, [&] {
    plant_.waitForTick();
    meanwhile();
  });
}

void SimulatedHands::act(const Question& question, const std::function<void()>& meanwhile) {
  const int found = model_.axisIndex(question.axis);
  const auto axis = static_cast<std::size_t>(std::max(found, 0));
  const DeviceAxis& a = model_.axes[axis];
  if (question.about == QuestionKind::kNobodyAttached) {
    for (std::size_t i = 0; i < model_.axes.size(); ++i) {
      plant_.place(i, 0.5 * (model_.axes[i].lower + model_.axes[i].upper));
    }
    reportSimulated("it stands on its mark, and nobody is attached.");
  } else if (question.about == QuestionKind::kPushAway) {
    carry(axis, plant_.position(axis) + kPushed * (a.upper - a.lower), meanwhile);
    reportSimulated(fmt::format("a hand has pushed axis {}. Enter says that you have.", a.name));
  } else if (question.about == QuestionKind::kTravel) {
    carry(axis, plant_.lowerStop(axis), meanwhile);
    carry(axis, plant_.upperStop(axis), meanwhile);
    const double travel = plant_.upperStop(axis) - plant_.lowerStop(axis);
    const double mark = kRulerReads * (a.upper - a.lower);
    reportSimulated(
        fmt::format("a hand has moved axis {} from stop to stop; the ruler reads {:.4g} {}.",
                    a.name, std::round(travel / mark) * mark, question.unit));
  } else if (question.about == QuestionKind::kKnownForce) {
    for (std::size_t i = 0; i < model_.axes.size(); ++i) plant_.pull(i, 0.0);
    const std::string force = fmt::format("{:.2g}", 0.5 * (question.lower + question.upper));
    plant_.pull(axis, -std::stod(force));
    reportSimulated(
        fmt::format("a weight pulls axis {} with {} {}.", a.name, force, question.unit));
  } else if (question.about == QuestionKind::kEmergencyStop) {
    plant_.pressStop(false);
    reportSimulated("the emergency stop is released.");
  }
}

void SimulatedHands::carry(std::size_t axis, double to, const std::function<void()>& meanwhile) {
  meanwhile();
  const double from = plant_.position(axis);
  for (int i = 1; i <= kByHand_ticks; ++i) {
    plant_.place(axis, from + (to - from) * i / kByHand_ticks);
    plant_.waitForTick();
    meanwhile();
  }
}

}  // namespace wholehand
