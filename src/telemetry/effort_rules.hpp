#pragma once

#include "telemetry/prediction_rules.hpp"

/// Rules of wall, damping and tank since schema 8 (kStepSchema). Private to telemetry.
namespace wholehand::recording {

/// A wall stays, or moves as the first touch: as it did better in the row before.
class WallPosition {
 public:
  explicit WallPosition(const Rules& rules)
      : closure_(rules.column("closure")), wall_(rules.column("wall")) {}

  double operator()(const RowWindow& w, std::size_t i) const {
    if (w.past() == 0) return 0.0;
    const double last = w.number(wall_, i, 1);
    if (w.past() == 1) return last;
    const bool moves = std::abs(last - moved(w, i, 1)) < std::abs(last - w.number(wall_, i, 2));
    const double now = moved(w, i, 0);
    return moves && std::isfinite(now) ? now : last;
  }

 private:
  /// Of the row `back` rows earlier, by the row before it.
  [[nodiscard]] double moved(const RowWindow& w, std::size_t i, std::uint64_t back) const {
    return w.number(closure_, i, back) -
           (w.number(closure_, i, back + 1) - w.number(wall_, i, back + 1));
  }

  std::size_t closure_, wall_;
};

/// Effort of the exercise's wall, Eq. (15) and (17): α (k p + d q̇_mf) at a depth p. The last two
/// rows tell k and d.
class WallEffort {
 public:
  explicit WallEffort(const Rules& rules)
      : q_m_(rules.column("q_m")),
        qd_mf_(rules.column("qd_mf")),
        wall_(rules.column("wall")),
        active_(rules.column("wall_active")),
        alpha_(rules.column("alpha")),
        effort_(rules.column("exercise_effort")) {}

  double operator()(const RowWindow& w, std::size_t i) const {
    if (w.past() < 2) return w.past() == 0 ? 0.0 : w.number(effort_, i, 1);
    const double p = depth(w, i, 0), alpha = w.number(alpha_, 0);
    if (!(w.number(active_, i) == 1.0 && p > 0.0)) return 0.0;
    const double p1 = depth(w, i, 1), p2 = depth(w, i, 2);
    const double v1 = w.number(qd_mf_, i, 1), v2 = w.number(qd_mf_, i, 2);
    const double push1 = push(w, i, 1), push2 = push(w, i, 2);
    const double determinant = p1 * v2 - p2 * v1;
    const double k = (push1 * v2 - push2 * v1) / determinant;
    const double d = (p1 * push2 - p2 * push1) / determinant;
    const double now = k * p + d * w.number(qd_mf_, i);
    return now > 0.0 ? -(alpha < 1.0 ? alpha : 1.0) * now : 0.0;  // 0 for a NaN
  }

 private:
  [[nodiscard]] double depth(const RowWindow& w, std::size_t i, std::uint64_t back) const {
    return w.number(q_m_, i, back) - w.number(wall_, i, back);
  }
  [[nodiscard]] double push(const RowWindow& w, std::size_t i, std::uint64_t back) const {
    return -w.number(effort_, i, back) / w.number(alpha_, 0, back);
  }

  std::size_t q_m_, qd_mf_, wall_, active_, alpha_, effort_;
};

/// Φ by Algorithm 1 and Eq. (5). What a base axis has of its own is not recorded where a hand axis
/// has more: it is followed from the first row of the chunk.
class ActivatedDamping {
 public:
  ActivatedDamping(const Rules& rules, const RecordingMeta& meta)
      : coupling_(rules.column("coupling")),
        exercise_(rules.column("exercise_effort")),
        phi_(rules.column("phi")),
        law_(meta.law),
        own_(law_.k_pm.size()) {
    for (const double hand : law_.hand_axis) any_hand_ = any_hand_ || hand != 0.0;
  }

  double operator()(const RowWindow& w, std::size_t i) {
    if (i == 0) expectRow(w);
    if (law_.hand_axis[i] != 0.0 || !any_hand_) return own_[i];
    return law_.palm_contact[i] != 0.0 && own_[i] > hand_ ? own_[i] : hand_;
  }

 private:
  void expectRow(const RowWindow& w) {
    const double hand_before =
        w.past() > 0 ? largest([&](auto i) { return w.number(phi_, i, 1); }) : 0.0;
    for (std::size_t i = 0; i < own_.size(); ++i) {
      double& own = own_[i];
      if (w.past() > 0) {
        const double before = w.number(phi_, i, 1);
        if (law_.hand_axis[i] != 0.0 || !any_hand_ || before != hand_before) own = before;
      }
      const double now = activation(w, i), kept = w.past() > 0 ? law_.phi_kept[i] * own : 0.0;
      own = kept > now ? kept : now;
    }
    hand_ = largest([this](auto i) { return own_[i]; });
  }
  template <class Number>
  [[nodiscard]] double largest(Number number) const {
    double most = 0.0;
    for (std::size_t i = 0; i < own_.size(); ++i) {
      if (law_.hand_axis[i] != 0.0 && number(i) > most) most = number(i);
    }
    return most;
  }
  [[nodiscard]] double activation(const RowWindow& w, std::size_t i) const {
    const double effort = std::abs(w.number(coupling_, i) + w.number(exercise_, i));
    const double dead = law_.effort_dead[i], full = law_.effort_full[i];
    if (!(full > dead)) return effort <= dead ? 0.0 : 1.0;
    const double share = (effort - dead) / (full - dead);
    if (share < 0.0) return 0.0;
    return share > 1.0 ? 1.0 : share;
  }

  std::size_t coupling_, exercise_, phi_;
  RecordedLaw law_;
  std::vector<double> own_;
  double hand_ = 0.0;
  bool any_hand_ = false;
};

/// Energy balance of the tank: from the effort that acted on the device, the energy stored in the
/// coupling's spring and the wall, an encoder step's uncertainty, the device's own damping from
/// schema 8 on, and the avatar's share.
class TankEnergy {
 public:
  TankEnergy(const Rules& rules, const RecordingMeta& meta)
      : tank_(rules.column("tank")),
        sent_(rules.column("sent")),
        q_m_(rules.column("q_m")),
        q_s_(rules.column("q_s")),
        qd_mf_(rules.column("qd_mf")),
        f_s_(rules.column("f_s")),
        limit_(rules.column("effort_limit")),
        exercise_(rules.column("exercise_effort")),
        wall_(rules.column("wall")),
        active_(rules.column("wall_active")),
        elapsed_(rules.column("elapsed_periods")),
        period_s_(meta.period_s),
        law_(meta.law),
        whole_(meta.schema >= kStepSchema && !meta.law.device_damping.empty()),
        speed_(law_.k_pm.size()) {}

  double operator()(const RowWindow& w, std::size_t i) {
    const double dissipated = whole_ ? dissipatedNow(w, i) : 0.0;
    const std::uint64_t delay = law_.output_delay_ticks;
    if (w.past() < delay + 2) return w.past() == 0 ? 0.0 : w.number(tank_, i, 1);
    const double acted = w.number(sent_, i, delay + 1);
    const double hidden =
        0.5 * law_.encoder_step[i] * std::abs(acted - w.number(sent_, i, delay + 2));
    const double moved = w.number(q_m_, i) - w.number(q_m_, i, 1);
    const double to_person =
        ((acted * moved + (stored(w, i, 0) - stored(w, i, 1))) + hidden) - dissipated;
    const double given = to_person + avatar(w, i) * (w.number(q_s_, i) - w.number(q_s_, i, 1));
    const double energy = w.number(tank_, i, 1) - given;
    if (!whole_) return energy;
    const double most = law_.tank_capacity[i];
    if (energy > most) return most;
    return energy < -most ? -most : energy;
  }

 private:
  static constexpr double kFilter_s = 2e-3;

  double dissipatedNow(const RowWindow& w, std::size_t i) {
    double& v = speed_[i];
    if (w.past() == 0) {
      v = w.number(qd_mf_, i);
      return 0.0;
    }
    const double elapsed_s = w.number<std::uint32_t>(elapsed_, 0) * period_s_;
    v = (kFilter_s * v + (w.number(q_m_, i) - w.number(q_m_, i, 1))) / (kFilter_s + elapsed_s);
    return law_.device_damping[i] * v * v * elapsed_s;
  }
  [[nodiscard]] double stored(const RowWindow& w, std::size_t i, std::uint64_t back) const {
    const double k = law_.k_pm[i];
    const double stretch = std::abs(w.number(q_m_, i, back) - w.number(q_s_, i, back));
    const double most = w.number(limit_, i, back);
    const double spring =
        k * stretch < most ? 0.5 * k * stretch * stretch : most * stretch - 0.5 * most * most / k;
    if (!whole_ || w.number(active_, i, back) != 1.0) return spring;
    const double depth = w.number(q_m_, i, back) - w.number(wall_, i, back);
    return spring + 0.5 * std::abs(w.number(exercise_, i, back) * depth);
  }
  [[nodiscard]] double avatar(const RowWindow& w, std::size_t i) const {
    const double most = w.number(limit_, i, 1), effort = w.number(f_s_, i, 1);
    if (effort > most) return most;
    return effort < -most ? -most : effort;
  }

  std::size_t tank_, sent_, q_m_, q_s_, qd_mf_, f_s_, limit_, exercise_, wall_, active_, elapsed_;
  double period_s_;
  RecordedLaw law_;
  bool whole_;  ///< with the device's damping, the wall and the capacity
  std::vector<double> speed_;
};

}  // namespace wholehand::recording
