#pragma once

/// Arithmetic of solver rows, four numbers at once: one instruction each in a function with
/// WHOLEHAND_VECTOR_CLONES on a processor with AVX, two elsewhere. Same bits in both: the order of
/// every sum is written out. Inlined into the function that calls it, for that function's
/// processor.
namespace wholehand::bullet {

/// Four doubles in memory, at any address of a double.
using FourNumbers = double __attribute__((vector_size(32), aligned(8), may_alias));

[[gnu::always_inline]] inline FourNumbers& four(double* first) {
  return *reinterpret_cast<FourNumbers*>(first);
}
[[gnu::always_inline]] inline const FourNumbers& four(const double* first) {
  return *reinterpret_cast<const FourNumbers*>(first);
}

/// Σ j_a v_a over the axes, and over two vectors of four. @tparam Width number of axes
template <int Width>
[[gnu::always_inline]] inline double alongRow(const double* jacobian, const double* change,
                                              const double* linear, const double* linear_velocity,
                                              const double* angular,
                                              const double* angular_velocity) {
  FourNumbers sum = four(linear) * four(linear_velocity) + four(angular) * four(angular_velocity);
  for (int a = 0; a < Width; a += 4) sum += four(jacobian + a) * four(change + a);
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/// to += factor · response
template <int Width>
[[gnu::always_inline]] inline void addScaled(double* to, double factor, const double* response) {
  for (int a = 0; a < Width; a += 4) four(to + a) += factor * four(response + a);
}

}  // namespace wholehand::bullet
