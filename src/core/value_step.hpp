#pragma once

#include <string_view>

namespace wholehand {

/// Step of the grid on which an exercise's value is reported, by the unit at the end of its name
/// (before a '/'): litres 2⁻³², metres 2⁻²⁴, newtons 2⁻²⁰. Finer digits are the noise of
/// arithmetic, and fill recordings. 0 for others: they are reported as computed.
[[nodiscard]] constexpr double valueStep(std::string_view name) noexcept {
  name = name.substr(0, name.find('/'));
  if (name.ends_with("_l") || name.ends_with("_l_s")) return 0x1p-32;
  if (name.ends_with("_m")) return 0x1p-24;
  return name.ends_with("_n") ? 0x1p-20 : 0.0;
}

}  // namespace wholehand
