#include "control/certificate/gain_search.hpp"

#include <cmath>

namespace wholehand {

double largestAllowed(double start, const std::function<bool(double)>& passes) {
  if (!(start > 0.0) || !std::isfinite(start)) return 0.0;
  // 0.9^110 is below 1e-5. The steps are counted because denormal numbers do not shrink by a tenth.
  constexpr int kSteps = 110;
  double high = start;
  double low = 0.9 * start;
  for (int i = 0; !passes(low); ++i) {
    if (i == kSteps) return 0.0;
    high = low;
    low *= 0.9;
  }
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (passes(middle) ? low : high) = middle;
  }
  return low;
}

double roundedDown(double value) {
  if (!(value >= 1e-300)) return 0.0;  // smaller numbers have no three digits
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::floor(value / unit) * unit;
}

}  // namespace wholehand
