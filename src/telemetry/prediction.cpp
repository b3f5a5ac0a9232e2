#include "telemetry/prediction.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cfenv>
#include <cmath>
#include <string_view>
#include <utility>

namespace wholehand::recording {
namespace {

// The bits of a computed NaN depend on the processor: the previous row is used instead.
std::uint64_t bitsOf(double expected, const RowWindow& window, std::size_t column, std::size_t i) {
  if (!std::isnan(expected)) return std::bit_cast<std::uint64_t>(expected);
  return window.past() > 0 ? window.number<std::uint64_t>(column, i, 1) : 0;
}

/// Columns in which the numbers of a row differ in size: deflate gains from rows as elements.
constexpr std::array<std::string_view, 7> kRowElements = {
    "qd_s", "f_s", "phi", "tank", "intention", "patient_effort", "exercise_values"};

/// Finds columns by name and collects their rules.
class Rules {
 public:
  Rules(const std::vector<ColumnShape>& columns, bool row_elements)
      : columns_(columns), row_elements_(row_elements) {}

  [[nodiscard]] bool has(const std::string& name) const { return column(name) < columns_.size(); }
  [[nodiscard]] std::size_t column(const std::string& name) const {
    const auto is_it = [&name](const ColumnShape& c) { return c.name == name; };
    return static_cast<std::size_t>(std::find_if(columns_.begin(), columns_.end(), is_it) -
                                    columns_.begin());
  }
  /// @param rule (const RowWindow&, i) -> double
  template <class Rule>
  void add(const std::string& name, Rule rule) {
    if (!has(name)) return;  // e.g. a recording without bodies, joints or parameters
    const std::size_t c = column(name), width = columns_[c].rowBytes() / sizeof(double);
    const bool row_elements = row_elements_ && std::find(kRowElements.begin(), kRowElements.end(),
                                                         name) != kRowElements.end();
    all_.push_back(
        {c, width, row_elements, [=](const RowWindow& w, std::uint64_t* expected) mutable {
           for (std::size_t i = 0; i < width; ++i) {
             expected[i] = bitsOf(rule(w, i), w, c, i);
           }
         }});
  }
  [[nodiscard]] std::vector<Prediction> take() { return std::move(all_); }

 private:
  const std::vector<ColumnShape>& columns_;
  bool row_elements_;
  std::vector<Prediction> all_;
};

/// Extrapolates the polynomial through the last `Order` rows: v + Δv + Δ²v + ..., with fewer rows
/// at the start of a chunk. A constant is predicted exactly.
template <std::size_t Order>
double extrapolate(const RowWindow& w, std::size_t column, std::size_t i) {
  if constexpr (Order == 0) {
    return 0.0;
  } else {
    if (w.past() < Order) return extrapolate<Order - 1>(w, column, i);
    std::array<double, Order> difference;
    for (std::size_t k = 0; k < Order; ++k) difference[k] = w.number(column, i, k + 1);
    const double last = difference[0];
    double next = last;
    for (std::size_t level = 1; level < Order; ++level) {
      for (std::size_t k = 0; k + level < Order; ++k) difference[k] -= difference[k + 1];
      next += difference[0];
    }
    return std::isfinite(next) ? next : last;
  }
}

template <std::size_t Order>
void addExtrapolated(Rules& rules, const char* name) {
  const std::size_t column = rules.column(name);
  rules.add(name, [column](const RowWindow& w, std::size_t i) {
    return extrapolate<Order>(w, column, i);
  });
}

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

void addMotion(Rules& rules, const RecordingMeta& meta) {
  const double period_s = meta.period_s;
  const std::size_t q_s = rules.column("q_s"), qd_s = rules.column("qd_s");
  const std::size_t tick = rules.column("tick");
  rules.add("time_s", [=](const RowWindow& w, std::size_t) {
    return static_cast<double>(w.number<std::uint64_t>(tick, 0)) * period_s;
  });
  addExtrapolated<5>(rules, "qd_s");
  rules.add("q_s", [=](const RowWindow& w, std::size_t i) {  // symplectic Euler
    if (w.past() == 0) return 0.0;
    return w.number(q_s, i, 1) + period_s * w.number(qd_s, i);
  });
}

// The velocity filter, and θ = θ₀ + G q_s.
void addKinematics(Rules& rules, const RecordingMeta& meta) {
  const double period_s = meta.period_s;
  const RecordedLaw& law = meta.law;
  const std::size_t q_m = rules.column("q_m"), qd_mf = rules.column("qd_mf");
  const std::size_t q_s = rules.column("q_s"), elapsed = rules.column("elapsed_periods");
  rules.add("qd_mf", [=, tau = law.filter_tau_s](const RowWindow& w, std::size_t i) {
    if (w.past() == 0) return 0.0;
    const double elapsed_s = w.number<std::uint32_t>(elapsed, 0) * period_s;
    const double moved = w.number(q_m, i) - w.number(q_m, i, 1);
    return (tau[i] * w.number(qd_mf, i, 1) + moved) / (tau[i] + elapsed_s);
  });
  const std::size_t axes = meta.axis_names.size();
  rules.add("theta", [=, theta0 = law.theta0, g = law.synergy](const RowWindow& w, std::size_t j) {
    double theta = theta0[j];
    for (std::size_t a = 0; a < axes; ++a) {
      const double share = g[j * axes + a];
      if (share != 0.0) theta += share * w.number(q_s, a);
    }
    return theta;
  });
}

// Eq. (2), before kRowElementSchema with the previous row's damping D; then Eq. (3) with this row's
// D.
void addCoupling(Rules& rules, const RecordingMeta& meta) {
  const std::size_t q_m = rules.column("q_m"), q_s = rules.column("q_s");
  const std::size_t qd_mf = rules.column("qd_mf"), qd_s = rules.column("qd_s");
  const std::size_t f_s = rules.column("f_s");
  const auto stretch = [=](const RowWindow& w, std::size_t i, std::uint64_t back) {
    return w.number(q_m, i, back) - w.number(q_s, i, back);
  };
  const auto rate = [=](const RowWindow& w, std::size_t i, std::uint64_t back) {
    return w.number(qd_mf, i, back) - w.number(qd_s, i, back);
  };
  if (meta.schema >= kRowElementSchema) {
    rules.add("f_s", CriticallyDampedEffort(rules, meta));
  } else {
    rules.add("f_s", [=, k = meta.law.k_pm](const RowWindow& w, std::size_t i) {
      double damping = 0.0;
      if (w.past() > 0 && rate(w, i, 1) != 0.0) {
        damping = (w.number(f_s, i, 1) - k[i] * stretch(w, i, 1)) / rate(w, i, 1);
      }
      return k[i] * stretch(w, i, 0) + damping * rate(w, i, 0);
    });
  }
  rules.add("coupling",
            [=, k = meta.law.k_pm, gamma = meta.law.gamma](const RowWindow& w, std::size_t i) {
              const double spring = k[i] * stretch(w, i, 0);
              return gamma[i] * (spring - w.number(f_s, i)) - spring;
            });
}

void addEfforts(Rules& rules, const RecordingMeta& meta) {
  const std::size_t phi = rules.column("phi"), qd_mf = rules.column("qd_mf");
  const std::size_t coupling = rules.column("coupling"), damping = rules.column("damping");
  const std::size_t exercise = rules.column("exercise_effort");
  const std::size_t tank_effort = rules.column("tank_effort"), rendered = rules.column("rendered");
  rules.add("phi", [=](const RowWindow& w, std::size_t i) {  // decays by a constant factor
    if (w.past() == 0) return 0.0;
    const double last = w.number(phi, i, 1);
    if (w.past() == 1 || last == 0.0 || w.number(phi, i, 2) == 0.0) return last;
    return last * (last / w.number(phi, i, 2));
  });
  rules.add("damping", [=, k = meta.law.k_dm](const RowWindow& w, std::size_t i) {
    return k.empty() ? 0.0 : -w.number(phi, i) * k[i] * w.number(qd_mf, i);
  });
  rules.add("rendered", [=](const RowWindow& w, std::size_t i) {
    return ((w.number(coupling, i) + w.number(exercise, i)) + w.number(damping, i)) +
           w.number(tank_effort, i);
  });
  rules.add("sent", [=](const RowWindow& w, std::size_t i) { return w.number(rendered, i); });
}

// Energy balance of the tank without the device's damping: from the effort that acted on the
// device, the energy stored in the coupling's spring, an encoder step's uncertainty, and the
// avatar's share.
void addTank(Rules& rules, const RecordingMeta& meta) {
  const std::size_t tank = rules.column("tank"), sent = rules.column("sent");
  const std::size_t q_m = rules.column("q_m"), q_s = rules.column("q_s");
  const std::size_t f_s = rules.column("f_s"), limit = rules.column("effort_limit");
  const auto stored = [=, k = meta.law.k_pm](const RowWindow& w, std::size_t i,
                                             std::uint64_t back) {
    const double stretch = std::abs(w.number(q_m, i, back) - w.number(q_s, i, back));
    const double most = w.number(limit, i, back);
    if (k[i] * stretch < most) return 0.5 * k[i] * stretch * stretch;
    return most * stretch - 0.5 * most * most / k[i];
  };
  const auto avatar = [=](const RowWindow& w, std::size_t i) {
    const double most = w.number(limit, i, 1), effort = w.number(f_s, i, 1);
    if (effort > most) return most;
    return effort < -most ? -most : effort;
  };
  const std::uint64_t delay = meta.law.output_delay_ticks;
  rules.add("tank", [=, step = meta.law.encoder_step](const RowWindow& w, std::size_t i) {
    if (w.past() < delay + 2) return w.past() == 0 ? 0.0 : w.number(tank, i, 1);
    const double acted = w.number(sent, i, delay + 1);
    const double hidden = 0.5 * step[i] * std::abs(acted - w.number(sent, i, delay + 2));
    const double moved = w.number(q_m, i) - w.number(q_m, i, 1);
    const double to_person = (acted * moved + (stored(w, i, 0) - stored(w, i, 1))) + hidden;
    const double given = to_person + avatar(w, i) * (w.number(q_s, i) - w.number(q_s, i, 1));
    return w.number(tank, i, 1) - given;
  });
}

/// Reproducible arithmetic on every machine: denormals are kept, rounding is to nearest.
class PlainArithmetic {
 public:
  PlainArithmetic() noexcept {
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~PlainArithmetic() { std::fesetenv(&before_); }
  PlainArithmetic(const PlainArithmetic&) = delete;
  PlainArithmetic& operator=(const PlainArithmetic&) = delete;

 private:
  std::fenv_t before_{};
};

// 0, -1, 1, -2 ... becomes 0, 1, 2, 3 ...: small differences have small bytes.
std::uint64_t folded(std::uint64_t difference) {
  return (difference << 1U) ^ (std::uint64_t{0} - (difference >> 63U));
}
std::uint64_t unfolded(std::uint64_t number) {
  return (number >> 1U) ^ (std::uint64_t{0} - (number & 1U));
}

}  // namespace

std::vector<Prediction> predictions(const std::vector<ColumnShape>& columns,
                                    const RecordingMeta& meta) {
  if (meta.schema < kPackedSchema) return {};
  const bool row_elements = meta.schema >= kRowElementSchema;
  Rules rules(columns, row_elements);
  addMotion(rules, meta);
  if (!meta.law.k_pm.empty()) {
    addKinematics(rules, meta);
    addCoupling(rules, meta);
  }
  addEfforts(rules, meta);
  if (meta.law.k_pm.empty()) {
    addExtrapolated<2>(rules, "tank");
  } else {
    addTank(rules, meta);
  }
  if (row_elements) {
    rules.add("intention", Oscillation(rules.column("intention"), meta.axis_names.size()));
    addExtrapolated<9>(rules, "patient_effort");
    addExtrapolated<7>(rules, "palm_distance_m");
  } else {
    addExtrapolated<6>(rules, "intention");
    for (const char* name : {"patient_effort", "palm_distance_m"}) addExtrapolated<5>(rules, name);
  }
  for (const char* name : {"bodies", "exercise_values", "parameters"}) {
    addExtrapolated<1>(rules, name);
  }
  const std::size_t palm = rules.column("palm_distance_m");
  rules.add("palm_target_distance_m",
            [palm](const RowWindow& w, std::size_t) { return w.number(palm, 0); });
  return rules.take();
}

void packRows(const std::vector<Prediction>& predictions, const RowBytes& columns,
              const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
              std::uint64_t begin, std::uint64_t end, RowBytes& packed) {
  const PlainArithmetic plain;
  RowWindow window(columns, row_bytes);
  std::vector<std::uint64_t> expected;
  for (const Prediction& p : predictions) {
    expected.resize(p.width);
    std::vector<std::byte>& out = packed[p.column];
    out.resize((end - begin) * row_bytes[p.column]);
    std::byte* to = out.data();
    for (std::uint64_t row = begin - begin % chunk_rows; row < end; ++row) {
      window.moveTo(row, row % chunk_rows);
      p.expect(window, expected.data());
      if (row < begin) continue;  // the rule learns from it
      for (std::size_t i = 0; i < p.width; ++i, to += sizeof(std::uint64_t)) {
        const auto bits = window.number<std::uint64_t>(p.column, i);
        const std::uint64_t number = folded(bits - expected[i]);
        std::memcpy(to, &number, sizeof number);
      }
    }
  }
}

void unpackRows(const std::vector<Prediction>& predictions, RowBytes& columns,
                const std::vector<std::size_t>& row_bytes, std::uint64_t chunk_rows,
                std::uint64_t rows) {
  const PlainArithmetic plain;
  RowWindow window(columns, row_bytes);
  std::vector<std::uint64_t> expected;
  for (const Prediction& p : predictions) {
    expected.resize(p.width);
    std::byte* at = columns[p.column].data();
    for (std::uint64_t row = 0; row < rows; ++row) {
      window.moveTo(row, row % chunk_rows);
      p.expect(window, expected.data());
      for (std::size_t i = 0; i < p.width; ++i, at += sizeof(std::uint64_t)) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, at, sizeof bits);
        bits = unfolded(bits) + expected[i];
        std::memcpy(at, &bits, sizeof bits);
      }
    }
  }
}

}  // namespace wholehand::recording
