#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"

#include <array>

namespace wholehand {

/// One number per axis, for linear algebra; no heap.
using AxisColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxAxes, 1>;

/// Position of an effort in its range: at an end or between.
enum class RangePart : signed char { kLow, kBetween, kHigh };
using RangeParts = std::array<RangePart, kMaxAxes>;

/// Box-constrained efforts λ in lower..upper that hold axes as far as possible: with v = w + G λ on
/// each axis
///   lower < λ < upper and v = 0,  or  λ = lower and v >= 0,  or  λ = upper and v <= 0.
/// This models dry friction and stops; v are the speeds at the end of a step. Bounds may be
/// infinite. Solved by block pivots (Judice and Pires 1994), with single pivots where these make no
/// progress; terminates for positive definite G. `parts` is the initial guess and the result.
/// @pre G symmetric positive definite, lower <= upper
/// @return false if G is not positive definite or the pivots run out; λ is then the last one tried.
/// Real-time safe.
WHOLEHAND_RT bool solveBox(const AxisMatrix& g, const AxisColumn& w, const AxisColumn& lower,
                           const AxisColumn& upper, RangeParts& parts, AxisColumn& lambda) noexcept;

}  // namespace wholehand
