#include "loop/patient/steered_player.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace wholehand {
namespace {

// An axis that is faster than any target by this factor runs away: what the person pushed against
// has yielded.
constexpr double kRunsAway = 1.2;
// An aim farther beyond the range than this many ranges is refused.
constexpr double kFarRanges = 10.0;

}  // namespace

FollowerState movingFollower(double position, double velocity,
                             const FollowerLimits& limits) noexcept {
  return {position, velocity, position + 2.0 * velocity / limits.rate_rad_s};
}

FollowerState follow(FollowerState state, double point, const FollowerLimits& limits,
                     double period_s) noexcept {
  const double most = limits.speed * period_s;
  const double wanted = std::clamp(point, limits.lower, limits.upper);
  state.goal += std::clamp(wanted - state.goal, -most, most);
  const double w = limits.rate_rad_s;
  const double fade = std::exp(-w * period_s);
  const double error = state.position - state.goal;
  const double push = state.velocity + w * error;
  state.position = state.goal + (error + push * period_s) * fade;
  state.velocity = (state.velocity - w * push * period_s) * fade;
  return state;
}

int firstFarAim(const DeviceModel& device, const AxisPosition& aim) noexcept {
  for (int i = 0; i < aim.size(); ++i) {
    const DeviceAxis& axis = device.axes[i];
    const double most = kFarRanges * (axis.upper - axis.lower);
    if (aim[i] < axis.lower - most || aim[i] > axis.upper + most) return i;
  }
  return -1;
}

std::string farAimText(const DeviceAxis& axis, double aim) {
  return fmt::format(
      "{} = {:.6g} {}: is far beyond the range {:.4g} to {:.4g} {}; give metres and "
      "radians",
      axis.name, aim, axis.positionUnit(), axis.lower, axis.upper, axis.positionUnit());
}

SteeredPlayer::SteeredPlayer(std::unique_ptr<Player> virtual_patient, const DeviceModel& device,
                             const SteeringConfig& config)
    : virtual_patient_(std::move(virtual_patient)), axes_(device.axisCount()) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  for (int i = 0; i < axes_; ++i) {
    const DeviceAxis& axis = device.axes[i];
    const double speed = config.speed_share * axis.speed_limit;
    person_limits_[i] = {axis.lower, axis.upper, speed, config.rate_rad_s};
    blend_limits_[i] = {-kAny, kAny, speed, config.blend_rad_s};
  }
  for (const char* name : {"finger_flexion", "thumb_flexion"}) {
    if (const int i = device.axisIndex(name); i >= 0)
      person_limits_[i].upper += config.grip_past_rad;
  }
  SteeredPlayer::reset();
}

void SteeredPlayer::reset() {
  virtual_patient_->reset();
  steering_ = Steering::kVirtualPatient;
  handed_back_ = false;
  offset_ = {};
  q_ = virtual_patient_->start();
  qd_ = AxisVelocity(axes_);
  seen_ = {};
}

void SteeredPlayer::takeOver() noexcept {
  help_ = Help::kUnspecified;
  aim_ = q_;
  for (int i = 0; i < axes_; ++i) {
    person_[i] = movingFollower(q_[i], qd_[i], person_limits_[i]);
    aim_[i] = person_[i].goal;  // comes to rest there without further targets
  }
}

void SteeredPlayer::command(const Command& command) noexcept {
  if (command.type == CommandType::kAim) {
    const bool ours = steering_ == Steering::kPerson && command.aim.size() == axes_;
    if (!ours || !allFinite(command.aim)) return;
    aim_ = command.aim;
    const bool said = command.index >= 0 && command.index < kHelps;
    help_ = said ? static_cast<Help>(command.index) : Help::kUnspecified;
  } else if (command.type == CommandType::kSteer) {
    const bool person = command.index == static_cast<std::int32_t>(Steering::kPerson);
    const Steering asked = person ? Steering::kPerson : Steering::kVirtualPatient;
    if (asked == steering_) return;
    steering_ = asked;
    handed_back_ = !person;
    if (person) takeOver();
  }
}

void SteeredPlayer::advance(double period_s, AxisPosition& q, AxisVelocity& qd) noexcept {
  period_s_ = period_s;
  if (steering_ == Steering::kPerson) {
    for (int i = 0; i < axes_; ++i) {
      person_[i] = follow(person_[i], aim_[i], person_limits_[i], period_s);
      q_[i] = person_[i].position;
      qd_[i] = person_[i].velocity;
    }
  } else {
    AxisPosition wanted;
    AxisVelocity wanted_speed;
    virtual_patient_->advance(period_s, wanted, wanted_speed);
    for (int i = 0; i < axes_; ++i) {
      if (handed_back_) {
        // Offset between the steered hand and the virtual patient's target one period ago.
        const double before = wanted[i] - period_s * wanted_speed[i];
        offset_[i] = movingFollower(q_[i] - before, qd_[i] - wanted_speed[i], blend_limits_[i]);
      }
      offset_[i] = follow(offset_[i], 0.0, blend_limits_[i], period_s);
      q_[i] = wanted[i] + offset_[i].position;
      qd_[i] = wanted_speed[i] + offset_[i].velocity;
    }
    handed_back_ = false;
  }
  q = q_;
  qd = qd_;
}

void SteeredPlayer::onRecord(const TickRecord& record) noexcept {
  virtual_patient_->onRecord(record);
  if (record.q_m.size() != axes_) return;
  if (steering_ == Steering::kPerson && seen_.size() == axes_) {
    holdBack(record.q_m, record.elapsed_periods * period_s_);
  }
  seen_ = record.q_m;
}

void SteeredPlayer::holdBack(const AxisPosition& q_m, double elapsed_s) noexcept {
  for (int i = 0; i < axes_; ++i) {
    const double fastest = person_limits_[i].speed;
    const double moved = q_m[i] - seen_[i];
    if (!(std::abs(moved) > kRunsAway * fastest * elapsed_s)) continue;
    person_[i] = movingFollower(q_m[i], std::copysign(fastest, moved), person_limits_[i]);
  }
}

}  // namespace wholehand
