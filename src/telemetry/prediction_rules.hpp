#pragma once

#include "telemetry/prediction.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What the prediction rules of a recording's columns are made of. Private to telemetry.
namespace wholehand::recording {

/// The bits of `expected`. The bits of a computed NaN depend on the processor: the previous row is
/// used instead.
inline std::uint64_t bitsOf(double expected, const RowWindow& window, std::size_t column,
                            std::size_t i) {
  if (!std::isnan(expected)) return std::bit_cast<std::uint64_t>(expected);
  return window.past() > 0 ? window.number<std::uint64_t>(column, i, 1) : 0;
}

/// Columns in which the numbers of a row differ in size: deflate gains from rows as elements.
constexpr std::array<std::string_view, 7> kRowElements = {
    "qd_s", "f_s", "phi", "tank", "intention", "patient_effort", "exercise_values"};
/// The same since kStepSchema.
constexpr std::array<std::string_view, 5> kMoreRowElements = {"q_m", "closure", "wall",
                                                              "exercise_effort", "bodies"};

/// Finds columns by name and collects their rules.
class Rules {
 public:
  Rules(const std::vector<ColumnShape>& columns, std::uint64_t schema)
      : columns_(columns), schema_(schema) {}

  [[nodiscard]] bool has(const std::string& name) const { return column(name) < columns_.size(); }
  [[nodiscard]] std::size_t column(const std::string& name) const {
    const auto is_it = [&name](const ColumnShape& c) { return c.name == name; };
    return std::find_if(columns_.begin(), columns_.end(), is_it) - columns_.begin();
  }
  /// @param rule (const RowWindow&, i) -> double
  /// @param steps of each number's grid; empty: none
  /// @param later see Prediction; empty: none
  template <class Rule>
  void add(const std::string& name, Rule rule, std::vector<double> steps = {},
           std::vector<bool> later = {}) {
    if (!has(name)) return;  // e.g. a recording without bodies, joints or parameters
    const std::size_t c = column(name), width = columns_[c].rowBytes() / sizeof(double);
    const auto among = [&name](const auto& names) {
      return std::find(names.begin(), names.end(), name) != names.end();
    };
    const bool row_elements = (schema_ >= kRowElementSchema && among(kRowElements)) ||
                              (schema_ >= kStepSchema && among(kMoreRowElements));
    if (std::find(later.begin(), later.end(), true) == later.end()) later.clear();
    if (steps.size() == 1) steps.resize(width, steps.front());
    all_.push_back({c, width, row_elements,
                    [=](const RowWindow& w, bool now, std::uint64_t* expected) mutable {
                      for (std::size_t i = 0; i < width; ++i) {
                        if (later.empty() || later[i] == now)
                          expected[i] = bitsOf(rule(w, i), w, c, i);
                      }
                    },
                    later, std::move(steps)});
  }
  [[nodiscard]] std::vector<Prediction> take() { return std::move(all_); }

 private:
  const std::vector<ColumnShape>& columns_;
  std::uint64_t schema_;
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

/// Steps of the grid on which the virtual patient's position and effort lie, since schema 7
/// (kGridSchema): of a metre or radian, and of a newton or newton metre.
inline constexpr double kIntentionSteps = 0x1p20, kEffortSteps = 0x1p24;

/// Steps of what is told of the avatar among the bodies, since schema 8 (kStepSchema).
inline constexpr double kProbeSteps = 0x1p24;

/// Counts steps from the polynomial. @param step of every number, or one for all
template <std::size_t Order>
void addSteps(Rules& rules, const char* name, std::vector<double> step) {
  const std::size_t column = rules.column(name);
  rules.add(
      name,
      [column](const RowWindow& w, std::size_t i) { return extrapolate<Order>(w, column, i); },
      std::move(step));
}

/// The point of the grid nearest to the polynomial. A zero is positive.
template <std::size_t Order>
void addOnGrid(Rules& rules, const char* name, double steps) {
  const std::size_t column = rules.column(name);
  rules.add(name, [column, steps](const RowWindow& w, std::size_t i) {
    return std::nearbyint(extrapolate<Order>(w, column, i) * steps) / steps + 0.0;
  });
}

}  // namespace wholehand::recording
