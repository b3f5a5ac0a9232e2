#pragma once

namespace wholehand::test {

/// An array over axes (AxisEffort, AxisPosition ...) of these numbers.
template <class Array, class... Numbers>
Array of(Numbers... numbers) {
  Array out(sizeof...(numbers));
  int axis = 0;
  ((out[axis++] = numbers), ...);
  return out;
}

}  // namespace wholehand::test
