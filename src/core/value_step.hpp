#pragma once

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace wholehand {

/// Values of exercises that are computed in every tick, by their names (before a '/'), and the
/// steps in which they are reported, of their units. Finer digits are the noise of arithmetic, and
/// fill recordings.
inline constexpr std::array<std::pair<std::string_view, double>, 10> kValueSteps = {{
    {"squeeze_n", 0x1p-24},
    {"row_y_m", 0x1p-24},
    {"palm_distance_m", 0x1p-24},
    {"flow_l_s", 0x1p-32},
    {"poured_l", 0x1p-32},
    {"poured_total_l", 0x1p-32},
    {"glass_l", 0x1p-32},
    {"spilt_l", 0x1p-32},
    {"left_l", 0x1p-32},
    {"layer_l", 0x1p-32},
}};

/// 0 for other values: they are reported as they are.
[[nodiscard]] constexpr double valueStep(std::string_view name) noexcept {
  name = name.substr(0, name.find('/'));
  const auto* const found = std::find_if(kValueSteps.begin(), kValueSteps.end(),
                                         [name](const auto& entry) { return entry.first == name; });
  return found != kValueSteps.end() ? found->second : 0.0;
}

}  // namespace wholehand
