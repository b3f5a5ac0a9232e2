#pragma once

/// Arithmetic of solver rows, four numbers at once: one instruction each in a function with
/// WHOLEHAND_VECTOR_CLONES on a processor with AVX, two elsewhere. Same bits in both: the order of
/// every sum is written out. Inlined into the function that calls it, for that function's
/// processor.
namespace wholehand::bullet {

using FourNumbers = double __attribute__((vector_size(32)));

// From and to memory at any address of a double. By reference: a vector that is returned would
// need AVX in the caller.
[[gnu::always_inline]] inline void load(FourNumbers& numbers, const double* from) {
  __builtin_memcpy(&numbers, from, sizeof numbers);
}
[[gnu::always_inline]] inline void store(const FourNumbers& numbers, double* to) {
  __builtin_memcpy(to, &numbers, sizeof numbers);
}

/// Σ j_a v_a over the axes, and over two vectors of four. @tparam Width number of axes
template <int Width>
[[gnu::always_inline]] inline double alongRow(const double* jacobian, const double* change,
                                              const double* linear, const double* linear_velocity,
                                              const double* angular,
                                              const double* angular_velocity) {
  FourNumbers a, b, c, d;
  load(a, linear), load(b, linear_velocity);
  load(c, angular), load(d, angular_velocity);
  FourNumbers sum = a * b + c * d;
  for (int i = 0; i < Width; i += 4) {
    load(a, jacobian + i), load(b, change + i);
    sum += a * b;
  }
  return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/// to += factor · response
template <int Width>
[[gnu::always_inline]] inline void addScaled(double* to, double factor, const double* response) {
  for (int i = 0; i < Width; i += 4) {
    FourNumbers sum, more;
    load(sum, to + i), load(more, response + i);
    sum += factor * more;
    store(sum, to + i);
  }
}

}  // namespace wholehand::bullet
