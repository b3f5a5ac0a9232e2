#include "devices/commissioning/mechanism.hpp"

namespace wholehand::test {

void Mechanism::advance(const std::vector<double>& effort) {
  constexpr int kSteps = 20;
  const double h = period_s_ / kSteps;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    State& s = states_[i];
    s.sent.push_front(effort[i]);
    if (s.sent.size() > 16) s.sent.pop_back();
  }
  for (int j = 0; j < kSteps; ++j) {
    for (std::size_t i = 0; i < axes_.size(); ++i) accelerate(i, (j + 0.5) * h, h);
    for (std::size_t i = 0; i < axes_.size(); ++i) move(i, h);
  }
}

// Effort that was sent one delay before this moment of the running period.
double Mechanism::acting(std::size_t i, double into_s) const {
  const double ago = axes_[i].delay_s - into_s;
  const auto back = static_cast<std::size_t>(ago <= 0.0 ? 0.0 : std::ceil(ago / period_s_));
  const auto& sent = states_[i].sent;
  return back < sent.size() ? sent[back] : sent.back();
}
void Mechanism::accelerate(std::size_t i, double into_s, double h) {
  const MechanismAxis& a = axes_[i];
  State& s = states_[i];
  const double hand = i < pushed.size() ? pushed[i] : 0.0;
  double f = acting(i, into_s) + hand - a.gravity - a.damping * s.speed;
  if (a.cogging > 0.0) f += a.cogging * std::sin(2.0 * M_PI * s.at / a.cogging_pitch);
  const double motor = a.mass * (1.0 - a.load_share);
  s.before = s.speed;
  if (a.load_share > 0.0) {
    // A stiff, damped spring beyond the play: 300 Hz with the load.
    const double load = a.mass * a.load_share, w = 2.0 * M_PI * 300.0;
    const double gap = s.load_at - s.at, over = gap - std::clamp(gap, -a.play / 2, a.play / 2);
    double between = load * w * w * over;
    if (over != 0.0) between += 0.4 * load * w * (s.load_speed - s.speed);
    f += between;
    s.load_speed -= h * between / load;
  }
  f -= linked(i);
  const double v = s.speed + h * f / motor;
  const double x = s.speed / a.stribeck_speed;
  const double friction = h * (a.coulomb + a.breakaway * std::exp(-x * x)) / motor;
  s.speed = std::abs(v) <= friction ? 0.0 : v - std::copysign(friction, v);
}
// Effort on this axis from the neighbours' accelerations in the step before.
double Mechanism::linked(std::size_t i) const {
  double f = 0.0;
  for (const std::size_t j : {i - 1, i + 1}) {
    if (j >= axes_.size()) continue;
    f += cross_inertia * std::sqrt(axes_[i].mass * axes_[j].mass) * states_[j].acceleration;
  }
  return f;
}
void Mechanism::move(std::size_t i, double h) {
  State& s = states_[i];
  s.acceleration = (s.speed - s.before) / h;
  s.at += h * s.speed;
  s.load_at += h * s.load_speed;
  if (s.at < axes_[i].lower || s.at > axes_[i].upper) {
    s.at = std::clamp(s.at, axes_[i].lower, axes_[i].upper);
    s.speed = 0.0;
  }
}

}  // namespace wholehand::test
