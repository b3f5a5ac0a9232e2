#include "commissioning/identification/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wholehand {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;
constexpr double kSpring_hz = 1.5;     // natural frequency of the soft spring
constexpr double kSpringRatio = 0.7;   // damping ratio of the spring
constexpr double kSweepShare = 0.4;    // share of each posture's time for the sweep
constexpr double kFilter_s = 0.004;    // time constant of the velocity filter
constexpr double kArrive_s = 0.5;      // time from one posture's centre to the next
constexpr double kEffortShare = 0.35;  // share of the limit: amplitude of the multisine of efforts
constexpr double kReferenceEffort = 0.45;  // share of the limit: largest effort of the reference
constexpr double kTravelShare = 0.2;  // share of the travel: amplitude about a posture's centre

constexpr std::array<double, 7> kSlow_hz = {0.31, 0.67, 1.13, 1.79, 2.57, 3.61, 4.73};
constexpr std::array<double, 10> kFast_hz = {6.1,  8.3,  10.9, 13.7, 16.9,
                                             20.3, 24.7, 29.3, 34.1, 39.7};

// Phases after Schroeder (1970), for a low crest factor.
double phase(std::size_t i, std::size_t count) {
  return -std::numbers::pi * static_cast<double>(i * i) / static_cast<double>(count);
}

}  // namespace

Excitation::Excitation(const ExcitationPlan& plan) : plan_(plan) {
  ticks_ = std::llround(plan.duration_s / plan.period_s);
  const double w = kTwoPi * kSpring_hz;
  stiffness_ = plan.mass * w * w;
  damping_ = 2.0 * kSpringRatio * plan.mass * w;
  const double room = plan.effort_limit - std::abs(plan.offset);
  effort_ = kEffortShare * std::max(room, 0.0);
  const double half = 0.5 * (plan.upper - plan.lower);
  amplitude_ = std::min(2.0 * kTravelShare * half,
                        kReferenceEffort * std::max(room, 0.0) / stiffness_ * 3.0);
}

int Excitation::posture() const {
  return static_cast<int>(std::min(tick_, ticks_ - 1) * kPostures / ticks_);
}

Excitation::Wanted Excitation::reference(double time_s, double centre) const {
  const double length_s = plan_.duration_s / kPostures;
  const double sweep_s = kSweepShare * length_s;
  Wanted out{centre, 0.0};
  if (time_s < kArrive_s) return out;
  if (time_s < sweep_s) {  // once to and fro at constant speed
    const double part = (time_s - kArrive_s) / (sweep_s - kArrive_s);
    const double leg = 4.0 * part;
    const double at = leg < 1.0 ? leg : leg < 3.0 ? 2.0 - leg : leg - 4.0;
    out.position += 1.5 * amplitude_ * at;
    out.velocity =
        1.5 * amplitude_ * (leg < 1.0 || leg >= 3.0 ? 4.0 : -4.0) / (sweep_s - kArrive_s);
    return out;
  }
  for (std::size_t i = 0; i < kSlow_hz.size(); ++i) {
    const double w = kTwoPi * kSlow_hz.at(i);
    const double a = amplitude_ * 0.6 / std::sqrt(static_cast<double>(kSlow_hz.size()));
    const double p = w * time_s + phase(i, kSlow_hz.size());
    out.position += a * std::sin(p);
    out.velocity += a * w * std::cos(p);
  }
  return out;
}

double Excitation::next(double position) {
  const double t = plan_.period_s;
  if (tick_ == 0) {
    last_ = position;
    wanted_ = position;
  }
  velocity_ = (kFilter_s * velocity_ + (position - last_)) / (kFilter_s + t);
  last_ = position;
  const double length_s = plan_.duration_s / kPostures;
  const double time_s = std::fmod(static_cast<double>(tick_) * t, length_s);
  const double middle = 0.5 * (plan_.lower + plan_.upper);
  const double centre =
      middle + kTravelShare * (plan_.upper - plan_.lower) * static_cast<double>(posture() - 1);
  const Wanted wanted = reference(time_s, centre);
  // Smooths jumps of the reference over a tenth of a second.
  wanted_ += (wanted.position - wanted_) * std::min(1.0, t / 0.05);
  double effort =
      plan_.offset + stiffness_ * (wanted_ - position) + damping_ * (wanted.velocity - velocity_);
  if (time_s >= kSweepShare * length_s) {
    for (std::size_t i = 0; i < kFast_hz.size(); ++i) {
      effort += effort_ / std::sqrt(static_cast<double>(kFast_hz.size())) *
                std::sin(kTwoPi * kFast_hz.at(i) * time_s + phase(i, kFast_hz.size()));
    }
  }
  ++tick_;
  return std::clamp(effort, -plan_.effort_limit, plan_.effort_limit);
}

}  // namespace wholehand
