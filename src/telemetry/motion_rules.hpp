#pragma once

#include "telemetry/posture_inertia.hpp"
#include "telemetry/prediction_rules.hpp"

#include <memory>

/// Rules of the avatar's motion by its inertia, since schema 8 (kStepSchema). Private to telemetry.
namespace wholehand::recording {

/// q̇_s of a step without contact: q̇_s⁻ + T M_r⁻¹ f_s⁻. A polynomial through the last five rows
/// after a step with contacts, and on an axis whose last number without contacts it expected better.
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
        law_(meta.law.k_pm.size()),
        polynomial_(law_.size()),
        by_law_(law_.size()),
        position_(law_.size()) {}

  double operator()(const RowWindow& w, std::size_t i) {
    if (i == 0) expectRow(w);
    return free_ && by_law_[i] && std::isfinite(law_[i]) ? law_[i] : polynomial_[i];
  }

 private:
  void expectRow(const RowWindow& w) {
    const std::size_t axes = law_.size();
    if (w.past() == 0) by_law_.assign(axes, true);
    for (std::size_t i = 0; i < axes && w.past() > 0 && free_; ++i) {
      const double v = w.number(qd_s_, i, 1);
      by_law_[i] = std::abs(v - law_[i]) <= std::abs(v - polynomial_[i]);
    }
    free_ = w.past() > 0 && w.number<std::int32_t>(contacts_, 0, 1) == 0;
    for (std::size_t i = 0; i < axes; ++i) polynomial_[i] = extrapolate<5>(w, qd_s_, i);
    if (!free_) return;
    for (std::size_t i = 0; i < axes; ++i) {
      position_[i] = w.number(q_s_, i, 1);
      law_[i] = w.number(f_s_, i, 1);
    }
    inertia_->at(position_);
    inertia_->solve(law_);
    for (std::size_t i = 0; i < axes; ++i) law_[i] = w.number(qd_s_, i, 1) + period_s_ * law_[i];
  }

  std::size_t q_s_, qd_s_, f_s_, contacts_;
  double period_s_;
  std::shared_ptr<PostureInertia> inertia_;
  bool free_ = false;  ///< the step to this row had no contacts: law_ is known
  std::vector<double> law_, polynomial_;
  std::vector<bool> by_law_;
  std::vector<double> position_;
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
