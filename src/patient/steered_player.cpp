#include "patient/steered_player.hpp"

#include <cmath>
#include <limits>
#include <utility>

namespace wholehand {
namespace {

// Faster than an aim by this much, an axis runs away: what a person pushed against has given way.
constexpr double kRunsAway = 1.2;

}  // namespace

SteeredPlayer::SteeredPlayer(std::unique_ptr<Player> virtual_patient, const DeviceModel& device,
                             const SteeringConfig& config)
    : virtual_patient_(std::move(virtual_patient)), axes_(device.axisCount()) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  for (int i = 0; i < axes_; ++i) {
    const DeviceAxis& axis = device.axes[static_cast<std::size_t>(i)];
    const double speed = config.speed_share * axis.speed_limit;
    const auto k = static_cast<std::size_t>(i);
    person_limits_[k] = {axis.lower, axis.upper, speed, config.rate_rad_s};
    blend_limits_[k] = {-kAny, kAny, speed, config.blend_rad_s};
  }
  SteeredPlayer::reset();
}

void SteeredPlayer::reset() {
  virtual_patient_->reset();
  steering_ = Steering::kVirtualPatient;
  handed_back_ = false;
  apart_ = {};
  q_ = virtual_patient_->start();
  qd_ = AxisVelocity(axes_);
  seen_ = {};
}

void SteeredPlayer::takeOver() noexcept {
  aim_ = q_;
  for (int i = 0; i < axes_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    person_[k] = movingFollower(q_[i], qd_[i], person_limits_[k]);
    aim_[i] = person_[k].goal;  // comes to rest there unless the person says otherwise
  }
}

void SteeredPlayer::command(const Command& command) noexcept {
  if (command.type == CommandType::kAim) {
    const bool ours = steering_ == Steering::kPerson && command.aim.size() == axes_;
    if (ours && allFinite(command.aim)) aim_ = command.aim;
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
      const auto k = static_cast<std::size_t>(i);
      person_[k] = follow(person_[k], aim_[i], person_limits_[k], period_s);
      q_[i] = person_[k].position;
      qd_[i] = person_[k].velocity;
    }
  } else {
    AxisPosition wanted;
    AxisVelocity wanted_speed;
    virtual_patient_->advance(period_s, wanted, wanted_speed);
    for (int i = 0; i < axes_; ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (handed_back_) {
        // Where the hand would have gone by itself and where it is asked to be, a period ago.
        const double before = wanted[i] - period_s * wanted_speed[i];
        apart_[k] = movingFollower(q_[i] - before, qd_[i] - wanted_speed[i], blend_limits_[k]);
      }
      apart_[k] = follow(apart_[k], 0.0, blend_limits_[k], period_s);
      q_[i] = wanted[i] + apart_[k].position;
      qd_[i] = wanted_speed[i] + apart_[k].velocity;
    }
    handed_back_ = false;
  }
  q = q_;
  qd = qd_;
}

void SteeredPlayer::see(const TickRecord& record) noexcept {
  virtual_patient_->see(record);
  if (record.q_m.size() != axes_) return;
  if (steering_ == Steering::kPerson && seen_.size() == axes_) {
    holdBack(record.q_m, record.elapsed_periods * period_s_);
  }
  seen_ = record.q_m;
}

void SteeredPlayer::holdBack(const AxisPosition& q_m, double elapsed_s) noexcept {
  for (int i = 0; i < axes_; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const double fastest = person_limits_[k].speed;
    const double moved = q_m[i] - seen_[i];
    if (!(std::abs(moved) > kRunsAway * fastest * elapsed_s)) continue;
    person_[k] = movingFollower(q_m[i], std::copysign(fastest, moved), person_limits_[k]);
  }
}

}  // namespace wholehand
