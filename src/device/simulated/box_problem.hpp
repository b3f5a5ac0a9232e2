#pragma once

#include "core/axis_array.hpp"
#include "core/real_time.hpp"

#include <array>

namespace wholehand {

/// One number per axis, for linear algebra; no heap.
using AxisColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxAxes, 1>;

/// Where an effort stands in its range: at an end of it, or between.
enum class RangePart : signed char { kLow, kBetween, kHigh };
using RangeParts = std::array<RangePart, kMaxAxes>;

/// Efforts λ in lower..upper that hold axes as far as they can: with v = w + G λ on each axis
///   lower < λ < upper and v = 0,  or  λ = lower and v >= 0,  or  λ = upper and v <= 0.
/// That is dry friction and stops: v are the speeds at the end of a step. Bounds may be infinite.
/// By block pivots (Judice and Pires 1994), with single ones where these do not get ahead: ends
/// for positive definite G. `parts` is the guess and becomes where each λ stands.
/// @pre G symmetric positive definite, lower <= upper  @return false: no such G; λ is the last
/// tried Real-time safe.
WHOLEHAND_RT bool solveBox(const AxisMatrix& g, const AxisColumn& w, const AxisColumn& lower,
                           const AxisColumn& upper, RangeParts& parts, AxisColumn& lambda) noexcept;

}  // namespace wholehand
