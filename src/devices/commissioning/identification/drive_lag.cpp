#include "devices/commissioning/identification/drive_lag.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace wholehand {
namespace {

constexpr int kMostDelay_periods = 8;
constexpr int kLags = 80;           // tried lags, equally far apart
constexpr double kNearly = 1.1;     // times the least residual
constexpr double kExplained = 0.1;  // largest residual, of the effort
constexpr std::size_t kLeast = 200;

// Rms residual of one delay and lag, relative to the measured effort; the gain is fitted.
double residual(const std::vector<double>& effort, const std::vector<double>& given, int delay,
                double share) {
  double y = 0.0, both = 0.0, own = 0.0, all = 0.0;
  for (std::size_t k = 0; k < given.size(); ++k) {
    both += y * given[k];
    own += y * y;
    all += given[k] * given[k];
    const auto back = static_cast<std::size_t>(delay);
    y += share * ((k < back ? effort.front() : effort[k - back]) - y);
  }
  if (own <= 0.0 || all <= 0.0) return 1.0;
  return std::sqrt(std::max(0.0, 1.0 - both * both / (own * all)));
}

}  // namespace

Interval identifyDriveLag(const std::vector<double>& effort, const std::vector<double>& given,
                          double period_s) {
  const Interval unknown{0.0, 0.0};
  if (given.size() < kLeast || effort.size() + 1 < given.size()) return unknown;
  if (!std::all_of(given.begin(), given.end(), [](double f) { return std::isfinite(f); })) {
    return unknown;
  }
  std::vector<double> sent = effort;
  sent.resize(given.size(), sent.back());
  std::vector<double> least(kLags, 1.0);
  for (int i = 0; i < kLags; ++i) {
    const double lag_s = kLongestDriveLag_s * (i + 1) / kLags;
    for (int delay = 0; delay <= kMostDelay_periods; ++delay) {
      const double apart = residual(sent, given, delay, 1.0 - std::exp(-period_s / lag_s));
      least[static_cast<std::size_t>(i)] = std::min(least[static_cast<std::size_t>(i)], apart);
    }
  }
  const double best = *std::min_element(least.begin(), least.end());
  if (best > kExplained) return unknown;
  const auto nearly = [&](double apart) { return apart <= kNearly * best + 1e-6; };
  const auto first = std::find_if(least.begin(), least.end(), nearly) - least.begin();
  const auto last = least.rend() - std::find_if(least.rbegin(), least.rend(), nearly) - 1;
  const double step_s = kLongestDriveLag_s / kLags;
  return {step_s * static_cast<double>(first),
          std::min(step_s * static_cast<double>(last + 2), kLongestDriveLag_s)};
}

}  // namespace wholehand
