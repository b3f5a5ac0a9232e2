// Arming of a renderer.
#include "physics/hand_probe.hpp"
#include "renderer/haptic_renderer.hpp"

#include <string>
#include <utility>

namespace wholehand {
namespace {

// Diagnostic of a refusal that concerns no file and no value.
Diagnostic armingProblem(const char* problem, const char* remedy) {
  return {"", 0, "", "", problem, remedy};
}

}  // namespace

// Checks before the device is opened.
Expected<Done> HapticRenderer::mayArm(const std::optional<RehearsalPassed>& rehearsed) const {
  if (!safety_.rendering() && !finished()) {
    return armingProblem("the device is still on its way to neutral", "arm again then");
  }
  if (device_.simulated()) return Done{};
  if (safety_.rendering()) {
    return armingProblem("the device is armed already", "stop it first");
  }
  if (config_.moves_nobody) return Done{};
  if (Expected<Done> cleared = device_.cleared(); !cleared) return cleared;
  if (!rehearsed) {
    return armingProblem("the device may move a person, and nothing was rehearsed",
                         "call rehearse() and arm with what it says has passed");
  }
  if (rehearsed->of() != config_.rehearsal) {
    return armingProblem("what was rehearsed is not what is to be rendered",
                         "rehearse these models, with these options");
  }
  return Done{};
}

// Checks that the reading is within the workspace.
Expected<Done> HapticRenderer::withinWorkspace() const {
  const SupervisorConfig& limits = config_.safety.supervisor;
  const Finding finding = safety_.judgeAtRest(reading_.q_m);
  if (!any(finding.faults)) return Done{};
  const int a = finding.axis;
  const std::string range =
      "[" + std::to_string(limits.lower[a]) + ", " + std::to_string(limits.upper[a]) + "]";
  return Diagnostic{"",
                    0,
                    axis_names_[a],
                    std::to_string(reading_.q_m[a]),
                    "is outside the device's workspace " + range,
                    "move it back by hand, or calibrate the device"};
}

// Nobody will tick it. A device that was open before keeps carrying its weight.
Expected<Done> HapticRenderer::refuseArming(Diagnostics why) {
  prepared_ = false;
  if (!was_open_) device_.close();
  device_open_ = was_open_;
  return why;
}

Expected<Done> HapticRenderer::prepare(const std::optional<RehearsalPassed>& rehearsed) {
  if (prepared_) return Done{};
  // A person requested this stop: it must not be lost.
  if (safety_.stops().consumeUnseen()) {
    return armingProblem("a stop was asked for", "arm again if it is over");
  }
  if (Expected<Done> may = mayArm(rehearsed); !may) return may;
  if (Expected<Done> opened = device_.open(); !opened) return opened;
  was_open_ = std::exchange(device_open_, true);
  if (Expected<Done> ready = device_.ready(); !ready) return refuseArming(ready.errors());
  if (any(device_.read(reading_, 1)) || !allFinite(reading_.q_m) ||
      reading_.q_m.size() != config_.gains.axes) {
    return refuseArming(
        {armingProblem("the device gives no position", "check that it is connected")});
  }
  if (Expected<Done> within = withinWorkspace(); !within) return refuseArming(within.errors());
  if (Expected<Done> placed = world_.placeHand(reading_.q_m); !placed) {
    return refuseArming(placed.errors());
  }
  armed_position_ = reading_.q_m;
  prepared_ = true;
  return Done{};
}

Expected<Done> HapticRenderer::arm(const std::optional<RehearsalPassed>& rehearsed) {
  if (!prepared_) {
    if (Expected<Done> prepared = prepare(rehearsed); !prepared) return prepared;
  }
  const auto stopped = [this] {
    return refuseArming(
        {armingProblem("a stop was asked for while the device was being armed", "")});
  };
  if (safety_.stops().consumeUnseen()) return stopped();
  if (Expected<Done> enabled = device_.enable(); !enabled) return refuseArming(enabled.errors());
  if (!safety_.stops().arm()) return stopped();
  prepared_ = false;
  const int axes = config_.gains.axes;
  velocity_ = VelocityState{};
  damping_ = AdaptiveDampingState{AxisRatio(axes), AxisRatio(axes)};
  parameters_.reset();
  contacts_ = ContactList{};
  query_ = WorldQuery{};
  probe_->reset();
  holder_alive_ = true;
  if (exercise_ != nullptr) {
    exercise_->reset();
    query_ = exercise_->query();
  }
  safety_.arm(armed_position_);
  return Done{};
}

void HapticRenderer::disarm() noexcept {
  prepared_ = false;
  safety_.disarm();
}

}  // namespace wholehand
