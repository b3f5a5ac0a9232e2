#pragma once

namespace wholehand::test {

/// An array over axes (AxisEffort, AxisPosition ...) with these values.
template <class Array, class... Numbers>
Array of(Numbers... numbers) {
  Array out(sizeof...(numbers));
  int axis = 0;
  ((out[axis++] = numbers), ...);
  return out;
}

}  // namespace wholehand::test
