#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"

namespace wholehand {

/// Inverse of a symmetric positive definite matrix by Cholesky factorisation. Returns false and a
/// zero inverse when a pivot is not positive and finite. Real-time safe: no heap.
[[nodiscard]] WHOLEHAND_RT bool invertPositiveDefinite(const AxisMatrix& matrix,
                                                       AxisMatrix& inverse) noexcept;

}  // namespace wholehand
