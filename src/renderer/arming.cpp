// How a renderer is armed, and when it has come to rest.
#include "renderer/haptic_renderer.hpp"

#include <string>
#include <utility>

namespace wholehand {
namespace {

// For so long a device that takes no effort is asked to take its neutral one.
constexpr double kNeutralWithin_s = 1.0;

// Why not, where no file and no value is to blame.
Diagnostic because(const char* problem, const char* remedy) {
  return {"", 0, "", "", problem, remedy};
}

}  // namespace

// Before the device is touched.
Expected<Done> HapticRenderer::mayArm(const std::optional<RehearsalPassed>& rehearsed) const {
  if (ramp_.phase != RampPhase::kRendering && !finished()) {
    return because("the device is still on its way to neutral", "arm again then");
  }
  if (device_.simulated()) return Done{};
  if (ramp_.phase == RampPhase::kRendering) {
    return because("the device is armed already", "stop it first");
  }
  if (config_.moves_nobody) return Done{};
  if (!rehearsed) {
    return because("the device may move a person, and nothing was rehearsed",
                   "call rehearse() and arm with what it says has passed");
  }
  if (rehearsed->of() != config_.rehearsal) {
    return because("what was rehearsed is not what is to be rendered",
                   "rehearse these models, with these options");
  }
  return Done{};
}

// What was read lies within the workspace.
Expected<Done> HapticRenderer::withinWorkspace() const {
  const SupervisorConfig& limits = config_.supervisor;
  DeviceWatchState nothing_known;
  const Finding finding = watchDevice(nothing_known, reading_.q_m, config_.neutral, 1, limits);
  if (!any(finding.faults)) return Done{};
  const int a = finding.axis;
  const std::string range =
      "[" + std::to_string(limits.lower[a]) + ", " + std::to_string(limits.upper[a]) + "]";
  return Diagnostic{"",
                    0,
                    axis_names_[static_cast<std::size_t>(a)],
                    std::to_string(reading_.q_m[a]),
                    "is outside the device's workspace " + range,
                    "move it back by hand, or calibrate the device"};
}

Expected<Done> HapticRenderer::arm(const std::optional<RehearsalPassed>& rehearsed) {
  // A stop that no tick has seen is a person's: it is never forgotten in silence.
  const std::uint32_t stops = stops_.load(std::memory_order_seq_cst);
  if (std::exchange(stops_seen_, stops) != stops) {
    return because("a stop was asked for", "arm again if it is over");
  }
  if (Expected<Done> may = mayArm(rehearsed); !may) return may;
  if (Expected<Done> opened = device_.open(); !opened) return opened;
  const bool was_open = std::exchange(device_open_, true);
  const auto refused = [this, was_open](Diagnostics why) {
    // Nobody will tick it; one that was open before carries its weight on.
    if (!was_open) device_.close();
    device_open_ = was_open;
    return Expected<Done>(std::move(why));
  };
  if (Expected<Done> ready = device_.ready(); !ready) return refused(ready.errors());
  if (any(device_.read(reading_, 1)) || !allFinite(reading_.q_m) ||
      reading_.q_m.size() != config_.gains.axes) {
    return refused({because("the device gives no position", "check that it is connected")});
  }
  if (Expected<Done> within = withinWorkspace(); !within) return refused(within.errors());
  if (Expected<Done> placed = world_.placeHand(reading_.q_m); !placed) {
    return refused(placed.errors());
  }
  // The emergencies first: who presses counts the stop first, so that none is taken for an old one.
  const std::uint32_t emergencies = emergencies_.load(std::memory_order_seq_cst);
  if (const std::uint32_t now = stops_.load(std::memory_order_seq_cst); now != stops) {
    stops_seen_ = now;
    return refused({because("a stop was asked for while the device was being armed", "")});
  }
  stops_armed_ = stops;
  emergencies_armed_ = emergencies;
  armed_position_ = reading_.q_m;
  const int axes = config_.gains.axes;
  velocity_ = VelocityState{};
  damping_ = AdaptiveDampingState{AxisRatio(axes), AxisRatio(axes)};
  tank_ = fullTank(config_.tank);
  ramp_ = engageFrom(config_.neutral);
  slew_.clear();
  parameters_.reset();
  contacts_ = ContactList{};
  query_ = WorldQuery{};
  owner_alive_ = true;
  if (exercise_ != nullptr) {
    exercise_->reset();
    query_ = exercise_->query();
  }
  device_watch_ = DeviceWatchState{};
  device_watch_.q = armed_position_;
  world_watch_ = WorldWatchState{};
  safety_state_ = SafetyState::kArmed;
  latched_ = Fault::kNone;
  acknowledged_ = config_.neutral;  // as open() leaves it
  unconfirmed_s_ = 0.0;
  return Done{};
}

void HapticRenderer::disarm() noexcept {
  ramp_.phase = RampPhase::kNeutral;
  ramp_.sent = acknowledged_;  // neutral, unless ticks have followed: then they let it down
  safety_state_ = any(latched_) ? SafetyState::kFaulted : SafetyState::kDisarmed;
}

bool HapticRenderer::finished() const noexcept {
  return atNeutral() || unconfirmed_s_ > kNeutralWithin_s;
}

bool HapticRenderer::atNeutral() const noexcept {
  if (ramp_.phase != RampPhase::kNeutral) return false;
  for (int i = 0; i < config_.gains.axes; ++i) {
    if (ramp_.sent[i] != config_.neutral[i]) return false;  // held back by the slew limit
  }
  return true;
}

}  // namespace wholehand
