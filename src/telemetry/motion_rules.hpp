#pragma once

#include "telemetry/posture_inertia.hpp"
#include "telemetry/prediction_rules.hpp"

#include <algorithm>
#include <memory>

/// Rules of the avatar's motion by its inertia, since schema 8 (kStepSchema). Private to telemetry.
namespace wholehand::recording {

/// q̇_s⁻ + T a with M_r a = f_s⁻, of a step without contacts. After a step with contacts, the base
/// axes' polynomials; from what they did follows what the hand axes do, because mostly the palm
/// touches. A polynomial on an axis where that was nearer in the last such row.
class SteppedVelocity {
 public:
  SteppedVelocity(const Rules& rules, const RecordingMeta& meta,
                  std::shared_ptr<PostureInertia> inertia)
      : q_s_(rules.column("q_s")),
        qd_s_(rules.column("qd_s")),
        f_s_(rules.column("f_s")),
        contacts_(rules.column("contact_count")),
        period_s_(meta.period_s),
        inertia_(std::move(inertia)),
        base_axes_(baseAxes(meta)),
        law_(meta.law.k_pm.size()),
        polynomial_(law_.size()),
        position_(law_.size()),
        by_law_(2, std::vector<bool>(law_.size())) {}

  /// The axes up to the first hand axis, if all behind it are hand axes; else all.
  static std::size_t baseAxes(const RecordingMeta& meta) {
    const std::vector<double>& hand = meta.law.hand_axis;
    const auto first = std::find_if(hand.begin(), hand.end(), [](double h) { return h != 0.0; });
    const bool all = std::all_of(first, hand.end(), [](double h) { return h != 0.0; });
    return all && !hand.empty() ? first - hand.begin() : meta.law.k_pm.size();
  }

  /// Hand axes behind base axes.
  static std::vector<bool> later(const RecordingMeta& meta) {
    std::vector<bool> out(meta.law.k_pm.size());
    const std::size_t base_axes = baseAxes(meta);
    for (std::size_t i = base_axes; i < out.size(); ++i) out[i] = base_axes > 0;
    return out;
  }

  double operator()(const RowWindow& w, std::size_t i) {
    if (i == 0) expectRow(w);
    if (i == base_axes_ && touches_ && w.past() > 0) expectHand(w);
    const bool known = w.past() > 0 && (!touches_ || i >= base_axes_);
    return known && by_law_[touches_][i] && std::isfinite(law_[i]) ? law_[i] : polynomial_[i];
  }

 private:
  void expectRow(const RowWindow& w) {
    const std::size_t axes = law_.size();
    if (w.past() == 0) by_law_.assign(2, std::vector<bool>(axes, true));
    for (std::size_t i = touches_ ? base_axes_ : 0; i < axes && w.past() > 1; ++i) {
      const double v = w.number(qd_s_, i, 1);
      by_law_[touches_][i] = std::abs(v - law_[i]) <= std::abs(v - polynomial_[i]);
    }
    for (std::size_t i = 0; i < axes; ++i) polynomial_[i] = extrapolate<5>(w, qd_s_, i);
    if (w.past() == 0) return;
    touches_ = w.number<std::int32_t>(contacts_, 0, 1) != 0;
    if (!touches_) expectStep(w, 0);
  }
  // What the base axes do is part of the row.
  void expectHand(const RowWindow& w) {
    for (std::size_t i = 0; i < base_axes_; ++i) {
      law_[i] = (w.number(qd_s_, i) - w.number(qd_s_, i, 1)) / period_s_;
    }
    expectStep(w, base_axes_);
  }
  void expectStep(const RowWindow& w, std::size_t known) {
    for (std::size_t i = 0; i < law_.size(); ++i) {
      position_[i] = w.number(q_s_, i, 1);
      if (i >= known) law_[i] = w.number(f_s_, i, 1);
    }
    inertia_->at(position_);
    inertia_->solve(law_, known);
    for (std::size_t i = known; i < law_.size(); ++i) {
      law_[i] = w.number(qd_s_, i, 1) + period_s_ * law_[i];
    }
  }

  std::size_t q_s_, qd_s_, f_s_, contacts_;
  double period_s_;
  std::shared_ptr<PostureInertia> inertia_;
  std::size_t base_axes_;
  bool touches_ = false;  ///< the step to this row had contacts
  std::vector<double> law_, polynomial_, position_;
  std::vector<std::vector<bool>> by_law_;  ///< without and with contacts
};

/// Bodies move on with the velocities of their row, symplectic Euler: position by velocity,
/// orientation by the turn about the angular velocity, a series up to its seventh power. Velocities
/// are polynomials through the last five rows.
class BodyMotion {
 public:
  BodyMotion(const Rules& rules, const RecordingMeta& meta)
      : bodies_(rules.column("bodies")), period_s_(meta.period_s) {}

  /// Positions and orientations.
  static std::vector<bool> later(const RecordingMeta& meta) {
    std::vector<bool> out(meta.body_names.size() * kNumbers);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = i % kNumbers < kVelocity;
    return out;
  }

  double operator()(const RowWindow& w, std::size_t i) {
    const std::size_t k = i % kNumbers, body = i - k;
    if (w.past() == 0) return 0.0;
    if (k >= kVelocity) return extrapolate<5>(w, bodies_, i);
    if (k < kTurn) return w.number(bodies_, i, 1) + period_s_ * w.number(bodies_, i + kVelocity);
    if (k == kTurn) turn(w, body);
    return turned_[k - kTurn];
  }

 private:
  static constexpr std::size_t kNumbers = 13, kTurn = 3, kVelocity = 7, kSpin = 10;

  void turn(const RowWindow& w, std::size_t body) {
    std::array<double, 4> q{};
    std::array<double, 3> v{};
    for (std::size_t k = 0; k < 4; ++k) q[k] = w.number(bodies_, body + kTurn + k, 1);
    for (std::size_t k = 0; k < 3; ++k) v[k] = w.number(bodies_, body + kSpin + k);
    turned_ = q;
    if (v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0) return;
    const double s =  // half the angle, squared
        ((v[0] * v[0] + v[1] * v[1]) + v[2] * v[2]) * (0.25 * period_s_ * period_s_);
    const double sine = 0.5 * period_s_ * (1.0 - s / 6.0 * (1.0 - s / 20.0 * (1.0 - s / 42.0)));
    const double c = 1.0 - s / 2.0 * (1.0 - s / 12.0 * (1.0 - s / 30.0));
    const double x = v[0] * sine, y = v[1] * sine, z = v[2] * sine;
    turned_[0] = ((c * q[0] + x * q[3]) + y * q[2]) - z * q[1];
    turned_[1] = ((c * q[1] + y * q[3]) + z * q[0]) - x * q[2];
    turned_[2] = ((c * q[2] + z * q[3]) + x * q[1]) - y * q[0];
    turned_[3] = ((c * q[3] - x * q[0]) - y * q[1]) - z * q[2];
    double square = 0.0;
    for (const double number : turned_) square += number * number;
    for (double& number : turned_) number /= std::sqrt(square);
  }

  std::size_t bodies_;
  double period_s_;
  std::array<double, 4> turned_{};
};

/// Eq. (2) with the damping of Eq. (14), critical for the axis's own inertia.
class InertialEffort {
 public:
  InertialEffort(const Rules& rules, const RecordingMeta& meta,
                 std::shared_ptr<PostureInertia> inertia)
      : q_m_(rules.column("q_m")),
        q_s_(rules.column("q_s")),
        qd_mf_(rules.column("qd_mf")),
        qd_s_(rules.column("qd_s")),
        period_s_(meta.period_s),
        k_(meta.law.k_pm),
        inertia_(std::move(inertia)),
        position_(k_.size()) {}

  double operator()(const RowWindow& w, std::size_t i) {
    if (i == 0) {
      for (std::size_t a = 0; a < k_.size(); ++a) position_[a] = w.number(q_s_, a);
      matrix_ = &inertia_->at(position_);
    }
    const double mass = (*matrix_)[i * (i + 3) / 2], k = k_[i] / mass;
    const double damping = mass * (2.0 * std::sqrt(k) - k * period_s_);
    return k_[i] * (w.number(q_m_, i) - w.number(q_s_, i)) +
           damping * (w.number(qd_mf_, i) - w.number(qd_s_, i));
  }

 private:
  std::size_t q_m_, q_s_, qd_mf_, qd_s_;
  double period_s_;
  std::vector<double> k_;
  std::shared_ptr<PostureInertia> inertia_;
  std::vector<double> position_;
  const std::vector<double>* matrix_ = nullptr;
};

}  // namespace wholehand::recording
