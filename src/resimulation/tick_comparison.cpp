#include "resimulation/tick_comparison.hpp"

#include "core/tick_digest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace wholehand {
namespace {

struct ComputedColumn {
  std::string_view name;
  std::vector<double> numbers;
};

std::vector<ComputedColumn> computed(const TickRecord& record) {
  std::vector<ComputedColumn> columns;
  visitComputed(record, [&columns](const char* name, const double* numbers, int count) {
    if (columns.empty() || columns.back().name != name) columns.push_back({name, {}});
    columns.back().numbers.insert(columns.back().numbers.end(), numbers, numbers + count);
  });
  return columns;
}

/// Columns that a recording keeps in double precision (recording_layout.cpp).
bool isDouble(std::string_view column) {
  return column == "q_m" || column == "parameters" || column == "events/value" ||
         column == "faults";
}

// Not ==: NaN equals itself, and 0 differs from -0.
template <class T>
bool same(T a, T b) {
  return (std::isnan(a) && std::isnan(b)) || (a == b && std::signbit(a) == std::signbit(b));
}

bool same(double a, double b, bool exact) {
  return exact ? same<double>(a, b) : same<float>(static_cast<float>(a), static_cast<float>(b));
}

void compare(const ComputedColumn& recorded, const ComputedColumn& again, bool exact,
             std::vector<TickDifference>& out) {
  const std::size_t count = recorded.numbers.size();
  TickDifference found{std::string(recorded.name), 0, 0, 0.0, 0.0};
  if (count != again.numbers.size()) {
    found.recorded = static_cast<double>(count);
    found.again = static_cast<double>(again.numbers.size());
    out.push_back(found);
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    const double a = recorded.numbers[i], b = again.numbers[i];
    if (same(a, b, exact || isDouble(recorded.name))) continue;
    if (found.numbers++ > 0) continue;
    found.place = static_cast<int>(i);
    found.recorded = a;
    found.again = b;
  }
  if (found.numbers > 0) out.push_back(found);
}

/// A column of one number per axis, by its length.
bool isPerAxis(const TickDifference& d) {
  constexpr std::array kNames = {"q_m",  "qd_mf",      "q_s",      "qd_s",     "effort_limit",
                                 "f_s",  "closure",    "phi",      "coupling", "exercise_effort",
                                 "wall", "damping",    "rendered", "tank",     "tank_effort",
                                 "sent", "wall_active"};
  return std::find(kNames.begin(), kNames.end(), d.column) != kNames.end();
}

}  // namespace

std::vector<TickDifference> differences(const TickRecord& recorded, const TickRecord& again,
                                        bool exact) {
  const std::vector<ComputedColumn> a = computed(recorded), b = computed(again);
  std::vector<TickDifference> out;
  const auto in = [](const std::vector<ComputedColumn>& columns, std::string_view name) {
    const auto found = std::find_if(columns.begin(), columns.end(),
                                    [name](const ComputedColumn& c) { return c.name == name; });
    return found == columns.end() ? ComputedColumn{name, {}} : *found;
  };
  for (const ComputedColumn& column : a) compare(column, in(b, column.name), exact, out);
  for (const ComputedColumn& column : b) {
    if (in(a, column.name).numbers.empty()) compare({column.name, {}}, column, exact, out);
  }
  return out;
}

std::string describe(const TickDifference& d, const std::vector<std::string>& axis_names) {
  if (d.numbers == 0) {
    return fmt::format("{}: {:.0f} numbers recorded, now {:.0f}", d.column, d.recorded, d.again);
  }
  const auto place = static_cast<std::size_t>(d.place);
  std::string where = d.column;
  if (isPerAxis(d) && place < axis_names.size()) {
    where += " of " + axis_names[place];
  } else if (d.place > 0 || d.numbers > 1) {
    where += fmt::format("[{}]", d.place);
  }
  std::string text = fmt::format("{}: recorded {:.9g}, now {:.9g}", where, d.recorded, d.again);
  const double more = d.again - d.recorded;
  if (std::isfinite(more)) {
    text += fmt::format(", {:.3g} {}", std::abs(more), more < 0.0 ? "less" : "more");
  }
  if (d.numbers > 1) text += fmt::format(" ({} numbers of it differ)", d.numbers);
  return text;
}

}  // namespace wholehand
