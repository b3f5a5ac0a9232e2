#pragma once

#include "core/axis_array.hpp"

namespace wholehand {

[[nodiscard]] inline AxisEffort sum(const AxisEffort& a, const AxisEffort& b) noexcept {
  AxisEffort out(a.size());
  for (int i = 0; i < a.size(); ++i) out[i] = a[i] + b[i];
  return out;
}

[[nodiscard]] inline AxisEffort difference(const AxisEffort& a, const AxisEffort& b) noexcept {
  AxisEffort out(a.size());
  for (int i = 0; i < a.size(); ++i) out[i] = a[i] - b[i];
  return out;
}

}  // namespace wholehand
