#include "control/gain_search.hpp"

#include <cmath>

namespace wholehand {

double largestAllowed(double start, const std::function<bool(double)>& passes) {
  if (!(start > 0.0) || !std::isfinite(start)) return 0.0;
  double high = start;
  double low = start;
  do {
    high = low;
    low *= 0.9;
    if (low < 1e-5 * start) return 0.0;
  } while (!passes(low));
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (passes(middle) ? low : high) = middle;
  }
  return low;
}

double roundedDown(double value) {
  if (!(value > 0.0)) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 2.0);
  return std::floor(value / unit) * unit;
}

}  // namespace wholehand
