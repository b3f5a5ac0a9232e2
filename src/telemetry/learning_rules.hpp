#pragma once

#include "telemetry/prediction_rules.hpp"

/// Rules that learn from the earlier rows of a chunk, since schema 6 (kRowElementSchema).
/// Private to telemetry.
namespace wholehand::recording {

/// Expects a sine on a straight line, as a person's tremor is: its second differences Δ obey
/// Δ = r Δ⁻ - Δ⁻⁻, and r is found by least squares over the rows of the chunk.
class Oscillation {
 public:
  Oscillation(std::size_t column, std::size_t width) : column_(column), sums_(width) {}

  double operator()(const RowWindow& w, std::size_t i) {
    Sums& s = sums_[i];
    if (w.past() == 0) s = {};
    if (w.past() < 5) return extrapolate<5>(w, column_, i);
    const double last = bend(w, i, 1), before = bend(w, i, 2);
    const double product = before * (last + bend(w, i, 3)), square = before * before;
    if (std::isfinite(product) && std::isfinite(square)) {
      s.products += product;
      s.squares += square;
    }
    const double rate = s.squares > 0.0 ? s.products / s.squares : 2.0;
    const double value = w.number(column_, i, 1);
    const double next = value + ((value - w.number(column_, i, 2)) + (rate * last - before));
    return std::isfinite(next) ? next : value;
  }

 private:
  struct Sums {
    double products = 0.0, squares = 0.0;
  };
  /// Second difference of the row `back` rows earlier.
  [[nodiscard]] double bend(const RowWindow& w, std::size_t i, std::uint64_t back) const {
    const double middle = w.number(column_, i, back + 1);
    return (w.number(column_, i, back) - middle) - (middle - w.number(column_, i, back + 2));
  }

  std::size_t column_;
  std::vector<Sums> sums_;
};

/// Eq. (2) with a damping that is a function of one axis's position, the reduced inertia's: a
/// parabola through the last three rows. Which axis that is, or none, is found every 25 rows.
class CriticallyDampedEffort {
 public:
  CriticallyDampedEffort(const Rules& rules, const RecordingMeta& meta)
      : q_m_(rules.column("q_m")),
        q_s_(rules.column("q_s")),
        qd_mf_(rules.column("qd_mf")),
        qd_s_(rules.column("qd_s")),
        f_s_(rules.column("f_s")),
        k_(meta.law.k_pm),
        source_(meta.law.k_pm.size()) {}

  double operator()(const RowWindow& w, std::size_t i) {
    if (w.past() == 0) source_[i] = i;
    if (w.past() % kChoiceRows == kFirstChoice) source_[i] = bestSource(w, i);
    double damping_now = 0.0;
    if (w.past() > 0) {
      damping_now = w.past() < 3 ? damping(w, i, 1) : expectedDamping(w, i, source_[i], 0);
    }
    return k_[i] * stretch(w, i, 0) + damping_now * rate(w, i, 0);
  }

 private:
  static constexpr std::uint64_t kChoiceRows = 25, kFirstChoice = 8, kJudgedRows = 4;

  [[nodiscard]] double stretch(const RowWindow& w, std::size_t i, std::uint64_t back) const {
    return w.number(q_m_, i, back) - w.number(q_s_, i, back);
  }
  [[nodiscard]] double rate(const RowWindow& w, std::size_t i, std::uint64_t back) const {
    return w.number(qd_mf_, i, back) - w.number(qd_s_, i, back);
  }
  [[nodiscard]] double damping(const RowWindow& w, std::size_t i, std::uint64_t back) const {
    const double speed = rate(w, i, back);
    return speed != 0.0 ? (w.number(f_s_, i, back) - k_[i] * stretch(w, i, back)) / speed : 0.0;
  }
  static double quotient(double a, double b) { return b != 0.0 ? a / b : 0.0; }

  /// Damping of the row `back` rows earlier, by the three rows before it. @param source axis; the
  /// number of axes: none, as in the row before
  [[nodiscard]] double expectedDamping(const RowWindow& w, std::size_t i, std::size_t source,
                                       std::uint64_t back) const {
    const double d1 = damping(w, i, back + 1);
    if (source == source_.size()) return d1;
    const double d2 = damping(w, i, back + 2), d3 = damping(w, i, back + 3);
    const double x = w.number(q_s_, source, back), x1 = w.number(q_s_, source, back + 1);
    const double x2 = w.number(q_s_, source, back + 2), x3 = w.number(q_s_, source, back + 3);
    const double slope = quotient(d1 - d2, x1 - x2);
    const double curve = quotient(slope - quotient(d2 - d3, x2 - x3), x1 - x3);
    return (d1 + slope * (x - x1)) + (curve * (x - x1)) * (x - x2);
  }

  [[nodiscard]] std::size_t bestSource(const RowWindow& w, std::size_t i) const {
    std::size_t best = source_.size();
    double least = judged(w, i, best);
    for (std::size_t source = 0; source < source_.size(); ++source) {
      const double error = judged(w, i, source);
      if (!(error < least)) continue;
      least = error;
      best = source;
    }
    return best;
  }
  [[nodiscard]] double judged(const RowWindow& w, std::size_t i, std::size_t source) const {
    double error = 0.0;
    for (std::uint64_t back = 1; back <= kJudgedRows; ++back) {
      error += std::abs(damping(w, i, back) - expectedDamping(w, i, source, back));
    }
    return error;
  }

  std::size_t q_m_, q_s_, qd_mf_, qd_s_, f_s_;
  std::vector<double> k_;
  std::vector<std::size_t> source_;  ///< per axis
};

}  // namespace wholehand::recording
