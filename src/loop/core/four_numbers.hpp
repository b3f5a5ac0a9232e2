#pragma once

/// Arithmetic on four numbers at once. On a processor with AVX, a function with
/// WHOLEHAND_VECTOR_CLONES does each operation in one instruction, elsewhere in two. Both give the
/// same bits, because the order of every sum is written out. The functions are inlined into their
/// caller and so compiled for the caller's processor. Results are references, because returning a
/// vector would need AVX in the caller.
namespace wholehand {

using FourNumbers = double __attribute__((vector_size(32)));

// Load from and store to memory at any address of a double.
[[gnu::always_inline]] inline void load(FourNumbers& numbers, const double* from) {
  __builtin_memcpy(&numbers, from, sizeof numbers);
}
[[gnu::always_inline]] inline void store(const FourNumbers& numbers, double* to) {
  __builtin_memcpy(to, &numbers, sizeof numbers);
}

/// Transposes a matrix of four rows.
[[gnu::always_inline]] inline void transpose(FourNumbers& r0, FourNumbers& r1, FourNumbers& r2,
                                             FourNumbers& r3) {
  const FourNumbers even01 = __builtin_shufflevector(r0, r1, 0, 4, 2, 6);
  const FourNumbers odd01 = __builtin_shufflevector(r0, r1, 1, 5, 3, 7);
  const FourNumbers even23 = __builtin_shufflevector(r2, r3, 0, 4, 2, 6);
  const FourNumbers odd23 = __builtin_shufflevector(r2, r3, 1, 5, 3, 7);
  r0 = __builtin_shufflevector(even01, even23, 0, 1, 4, 5);
  r1 = __builtin_shufflevector(odd01, odd23, 0, 1, 4, 5);
  r2 = __builtin_shufflevector(even01, even23, 2, 3, 6, 7);
  r3 = __builtin_shufflevector(odd01, odd23, 2, 3, 6, 7);
}

/// Four vectors; `x` holds the x of each.
struct FourVectors {
  FourNumbers x, y, z;
};

/// to = a·b
[[gnu::always_inline]] inline void dot(FourNumbers& to, const FourVectors& a,
                                       const FourVectors& b) {
  to = a.x * b.x + a.y * b.y + a.z * b.z;
}

/// to = a × b
[[gnu::always_inline]] inline void cross(FourVectors& to, const FourVectors& a,
                                         const FourVectors& b) {
  to.x = a.y * b.z - a.z * b.y;
  to.y = a.z * b.x - a.x * b.z;
  to.z = a.x * b.y - a.y * b.x;
}

}  // namespace wholehand
