#include "report/html_text.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace wholehand {

std::string formatNumber(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  std::array<char, 400> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, std::abs(value));
  const std::string digits = text.data();
  const bool zero = digits.find_first_not_of("0.") == std::string::npos;
  return value < 0.0 && !zero ? std::string("−").append(digits) : digits;
}

}  // namespace wholehand
