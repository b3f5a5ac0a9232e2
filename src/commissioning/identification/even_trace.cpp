#include "commissioning/identification/even_trace.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>

namespace wholehand {
namespace {

constexpr double kLongestGap_periods = 5.0;
constexpr double kOff_periods = 0.5;
constexpr double kMostOff = 0.05;  // share of the ticks
constexpr double kOnTime_periods = 1e-6;

Expected<Done> judge(const std::vector<double>& taken_s, double period_s, const std::string& axis) {
  double longest_s = 0.0;
  std::size_t off = 0;
  for (std::size_t k = 1; k < taken_s.size(); ++k) {
    const double gap_s = taken_s[k] - taken_s[k - 1];
    longest_s = std::max(longest_s, gap_s);
    off += std::abs(gap_s - period_s) > kOff_periods * period_s ? 1 : 0;
  }
  const bool gap = longest_s > kLongestGap_periods * period_s;
  if (!gap && static_cast<double>(off) <= kMostOff * static_cast<double>(taken_s.size())) {
    return Done{};
  }
  std::array<char, 128> text{};
  std::snprintf(text.data(), text.size(),
                "was measured by a machine that was late: %zu of %zu ticks, at most %.1f ms apart",
                off, taken_s.size(), 1e3 * longest_s);
  return Diagnostic{"",   0,           "axes",
                    axis, text.data(), "let nothing else run on this machine, and repeat the step"};
}

// Mean effort from `from_s` to `to_s`, each effort held until the next; `at` is the tick whose
// effort holds at `from_s`.
double meanEffort(const AxisTrace& ticks, const std::vector<double>& taken_s, std::size_t at,
                  double from_s, double to_s) {
  double sum = 0.0, since_s = from_s;
  for (; since_s < to_s; ++at) {
    const bool last = at + 1 >= taken_s.size();
    const double until_s = last ? to_s : std::min(to_s, taken_s[at + 1]);
    sum += ticks.effort[at] * std::max(0.0, until_s - since_s);
    since_s = std::max(since_s, until_s);
    if (last) break;
  }
  return sum / (to_s - from_s);
}

}  // namespace

Expected<AxisTrace> evenTrace(const AxisTrace& ticks, const std::vector<double>& taken_s,
                              const std::string& axis) {
  const double t = ticks.period_s;
  const std::size_t n = taken_s.size();
  if (n == 0 || ticks.position.size() != n || ticks.effort.size() != n) return ticks;
  bool on_time = true;
  for (std::size_t k = 0; k < n; ++k) {
    on_time &= std::abs(taken_s[k] - static_cast<double>(k) * t) < kOnTime_periods * t;
  }
  if (on_time) return ticks;
  if (auto good = judge(taken_s, t, axis); !good) return good.errors();
  AxisTrace out;
  out.period_s = t;
  std::size_t at = 0;
  for (std::size_t k = 0;; ++k) {
    const double time_s = static_cast<double>(k) * t;
    while (at + 1 < n && taken_s[at + 1] <= time_s) ++at;
    if (at + 1 >= n) break;
    const double share = (time_s - taken_s[at]) / (taken_s[at + 1] - taken_s[at]);
    out.position.push_back(ticks.position[at] +
                           share * (ticks.position[at + 1] - ticks.position[at]));
    out.effort.push_back(meanEffort(ticks, taken_s, at, time_s, time_s + t));
    out.posture.push_back(ticks.posture[at]);
  }
  return out;
}

}  // namespace wholehand
