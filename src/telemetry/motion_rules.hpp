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
